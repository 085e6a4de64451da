// Which solids a pack's particles and sticks may touch in a step: for all lanes at once, what none
// of them comes near left out by bounds. docs/fast.md#search.
#pragma once

#include <cstdint>

#include "core/fast/lane_look.h"

namespace ragdoll::fast {

template <class L>
RAGDOLL_INLINE V3<typename L::R> fromOrigins(const L& w, const double* place) {
  V3<typename L::R> out{};
  for (int l = 0; l < L::W; ++l) {
    setLane(out.x, l, typename L::N(place[0] - w.origin[l][0]));
    setLane(out.y, l, typename L::N(place[1] - w.origin[l][1]));
    setLane(out.z, l, typename L::N(place[2] - w.origin[l][2]));
  }
  return out;
}

template <class R>
RAGDOLL_INLINE V3<R> intoFrame(const double* axes, const V3<R>& d) {
  using N = typename tree::NumberOf<R>::Type;
  return {N(axes[0]) * d.x + N(axes[1]) * d.y + N(axes[2]) * d.z,
          N(axes[3]) * d.x + N(axes[4]) * d.y + N(axes[5]) * d.z,
          N(axes[6]) * d.x + N(axes[7]) * d.y + N(axes[8]) * d.z};
}

/// Where one solid is, and whether any lane's bounds come near it. centre, half: of the bounds.
template <class L>
RAGDOLL_INLINE bool isNear(const Solid& o, const L& w, const V3<typename L::R>& centre,
                           const V3<typename L::R>& half, SolidPlace<typename L::R>& s) {
  using R = typename L::R;
  using N = typename L::N;
  s.at1 = fromOrigins(w, o.place1);
  s.at0 = o.moves ? fromOrigins(w, o.place0) : s.at1;
  const V3<R> way = centre - N(0.5) * (s.at0 + s.at1);
  const auto along = [](const R& d, const R& reach, double extent) {
    return less(signOf(d) * d, reach + N(extent));
  };
  return any(both(along(way.x, half.x, o.extent[0]),
                  both(along(way.y, half.y, o.extent[1]), along(way.z, half.z, o.extent[2]))));
}

template <class R>
RAGDOLL_INLINE V3<R> smaller3(const V3<R>& a, const V3<R>& b) {
  return {smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z)};
}
template <class R>
RAGDOLL_INLINE V3<R> larger3(const V3<R>& a, const V3<R>& b) {
  return {larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z)};
}

/// In which lanes three numbers are less than others, 16 bits each.
template <class R>
RAGDOLL_INLINE std::uint64_t lessBits(const V3<R>& a, const V3<R>& b) {
  const std::uint64_t x = lanesOf(less(a.x, b.x)), y = lanesOf(less(a.y, b.y));
  return x | y << 16 | std::uint64_t(lanesOf(less(a.z, b.z))) << 32;
}

/// Of a particle that goes from here to there.
template <class R, class N>
RAGDOLL_INLINE Reach reachOf(const V3<R>& here, const V3<R>& there, N radius, const V3<R>& bound) {
  const V3<R> r{R{} + radius, R{} + radius, R{} + radius};
  return {lessBits(smaller3(here, there) - r, bound),
          lessBits(V3<R>{} - bound, larger3(here, there) + r)};
}

/// The lanes where the bounds of a feature's particles come near, a bit each.
RAGDOLL_INLINE unsigned comesNear(const Feature& f, const Reach* reach) {
  const Reach& a = reach[f.a];
  const Reach& b = reach[f.b < 0 ? f.a : f.b];
  const std::uint64_t both = (a.below | b.below) & (a.above | b.above);
  return static_cast<unsigned>(both & both >> 16 & both >> 32 & 0xffff);
}

template <class L>
RAGDOLL_INLINE bool isHeld(const FastBody& b, const L&, const Feature& f) {
  return f.b < 0 && f.link < 0 && b.tree.roots[0].pinned;
}

/// The same of a whole body, as centre and half of the extent. pad: [m] beside the radii.
template <class L, class At>
RAGDOLL_INLINE void setBounds(const FastBody& b, const At& at, const typename L::R& pad,
                              V3<typename L::R>& centre, V3<typename L::R>& half) {
  using R = typename L::R;
  using N = typename L::N;
  V3<R> low = load3(at(0)), high = low;
  N radius = 0;
  for (int i = 0; i < b.particles; ++i) {
    const V3<R> p = load3(at(i));
    low = smaller3(low, p);
    high = larger3(high, p);
    if (radius < N(b.features[i].radius[0])) radius = N(b.features[i].radius[0]);
  }
  centre = N(0.5) * (low + high);
  const R more = pad + radius;
  half = N(0.5) * (high - low) + V3<R>{more, more, more};
}

/// Where particles are at both ends of the step in a solid's frame, and where they come near it.
template <class L>
RAGDOLL_SECTION void boundWays(const FastBody& b, const Solid& o,
                               const SolidPlace<typename L::R>& s, L& w) {
  using R = typename L::R;
  for (int i = 0; i < b.particles; ++i) {
    const V3<R> x = load3(w.x + 3 * i);
    const V3<R> here = intoFrame(o.axes0, x - s.at0);
    const V3<R> there = intoFrame(o.axes1, (x - s.at1) + load3(w.dx + 3 * i));
    store3(here, w.here + 3 * i);
    store3(there, w.there + 3 * i);
    w.reach[i] = reachOf(here, there, typename L::N(b.features[i].radius[0]), s.bound);
  }
}

/// The particles, then the sticks, whose bounds come near a solid.
template <class L>
RAGDOLL_SECTION void findNear(const FastBody& b, L& w) {
  w.near_count = w.near_particles = 0;
  for (std::size_t f = 0; f < b.features.size(); ++f) {
    const Feature& k = b.features[f];
    unsigned near = comesNear(k, w.reach);
    if (near == 0 || isHeld(b, w, k)) continue;
    for (; near != 0; near &= near - 1)
      w.near[w.near_count++] = {static_cast<int>(f), __builtin_ctz(near)};
    if (k.b < 0) w.near_particles = w.near_count;
  }
}

/// Calls to(batch, whether it is sticks) for what findNear has found.
template <class L, class To>
RAGDOLL_INLINE void forBatches(const typename L::R& margin, const SolidPlace<typename L::R>& s,
                               const L& w, const To& to) {
  for (const bool sticks : {false, true}) {
    const int end = sticks ? w.near_count : w.near_particles;
    for (int i = sticks ? w.near_particles : 0; i < end; i += L::W)
      to(batchOf<L>(w.near + i, end - i, margin, s), sticks);
  }
}

/// Contacts with solids that the free motion, from w.x by w.dx, comes near.
template <class L>
RAGDOLL_SECTION void findSolids(const FastBody& b, const PackStep& step, Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  if (step.solid_count == 0) return;
  const R margin = smaller(smaller(R{} + N(kMargin), N(kAside) * w.h), w.margin);
  V3<R> centre, half;
  setBounds<L>(
      b, [&](int i) { return w.x + 3 * i; }, margin + w.travel, centre, half);
  for (int j = 0; j < step.solid_count; ++j) {
    const Solid& o = step.solids[j];
    SolidPlace<R> s;
    if (!isNear(o, w, centre, half, s)) continue;
    const R reach = margin + N(o.radius);
    s.bound = {reach + N(o.half[0]), reach + N(o.half[1]), reach + N(o.half[2])};
    boundWays(b, o, s, w);
    findNear(b, w);
    forBatches(margin, s, w, [&](const PairBatch<L>& batch, bool sticks) {
      if (sticks)
        look(o, j, batch, stickPath(b, w, batch), lanes);
      else
        look(o, j, batch, particlePath(b, w, batch), lanes);
    });
  }
}

/// The pairs of a batch that are deep in a solid, at w.there.
template <class L>
RAGDOLL_INLINE auto deepParticles(const FastBody& b, const PackStep& step, const Solid& o,
                                  const L& w, const PairBatch<L>& batch) {
  using N = typename L::N;
  const auto path = particlePath(b, w, batch);
  return less(wayTo(path.to, o).distance, path.radius + N(o.radius - step.bounds.particle));
}
template <class L>
RAGDOLL_INLINE auto deepSticks(const FastBody& b, const PackStep& step, const Solid& o, const L& w,
                               const PairBatch<L>& batch) {
  using N = typename L::N;
  const auto axis = stickPath(b, w, batch).axis(typename L::R{} + N(1));
  const auto n = nearestPlace(axis, o);
  return less(n.distance, (axis.radius + N(o.radius - step.bounds.stick)) + axis.taper * n.at);
}

/// Lanes in which, at w.x, something is deep in a solid.
template <class L>
RAGDOLL_SECTION void findDeep(const FastBody& b, const PackStep& step, Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  for (int l = 0; l < L::W; ++l) lanes[l].deep = false;
  V3<R> centre, half;
  if (step.solid_count == 0) return;
  setBounds<L>(
      b, [&](int i) { return w.x + 3 * i; }, R{} - N(step.bounds.particle), centre, half);
  for (int j = 0; j < step.solid_count; ++j) {
    const Solid& o = step.solids[j];
    SolidPlace<R> s;
    if (!isNear(o, w, centre, half, s)) continue;
    const R reach = R{} + N(o.radius - step.bounds.particle);
    s.bound = {reach + N(o.half[0]), reach + N(o.half[1]), reach + N(o.half[2])};
    for (int i = 0; i < b.particles; ++i) {
      const V3<R> there = intoFrame(o.axes1, load3(w.x + 3 * i) - s.at1);
      store3(there, w.there + 3 * i);
      w.reach[i] = reachOf(there, there, N(b.features[i].radius[0]), s.bound);
    }
    findNear(b, w);
    forBatches(R{}, s, w, [&](const PairBatch<L>& batch, bool sticks) {
      const unsigned deep = lanesOf(both(batch.mask, sticks ? deepSticks(b, step, o, w, batch)
                                                            : deepParticles(b, step, o, w, batch)));
      for (int i = 0; deep >> i != 0; ++i)
        if (deep >> i & 1) lanes[batch.pairs[i].lane].deep = true;
    });
  }
}

}  // namespace ragdoll::fast
