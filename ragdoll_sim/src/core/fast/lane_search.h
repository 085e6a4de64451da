// Which solids a pack's particles and sticks may touch in a step, and with which planes: for all
// lanes at once, what none of them comes near left out by bounds. As contact/detect.h, but that a
// first touch is located to millimetres and that what is left over goes there. docs/fast.md#search.
#pragma once

#include "core/fast/lane_distance.h"
#include "core/fast/lane_work.h"

namespace ragdoll::fast {

/// What is near a solid at one time of the step, in its frame.
template <class R>
struct Touch {
  V3<R> normal, at;  ///< at: of the particle, or of the stick's axis
  R place;           ///< along the stick
  R distance, gap;   ///< [m] of `at` from the core; of the surfaces
  R time;            ///< in [0, 1]
};

template <class M, class R>
RAGDOLL_INLINE V3<R> select(const M& m, const V3<R>& a, const V3<R>& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}
template <class M, class R>
RAGDOLL_INLINE void take(const M& m, const Touch<R>& from, Touch<R>& to) {
  to = {select(m, from.normal, to.normal), select(m, from.at, to.at),
        select(m, from.place, to.place),   select(m, from.distance, to.distance),
        select(m, from.gap, to.gap),       select(m, from.time, to.time)};
}

template <class R>
struct ParticlePath {
  using N = typename tree::NumberOf<R>::Type;
  V3<R> from, to;
  N radius;

  R travel() const { return squareRoot(dot(to - from, to - from)); }
  N thin() const { return radius; }
  RAGDOLL_INLINE auto unclear(const Touch<R>& t) const { return less(t.time, R{} - N(1)); }
  /// [m] Least gap on the way to the plane between it and the solid as found: the solid is no
  /// nearer.
  RAGDOLL_INLINE R apart(const Solid&, const Touch<R>& t) const {
    return t.gap + smaller(dot(t.normal, from - t.at), dot(t.normal, to - t.at));
  }
  RAGDOLL_INLINE Touch<R> at(const Solid& o, const R& time) const {
    const V3<R> p = from + time * (to - from);
    const Way<R> way = wayTo(p, o);
    return {way.normal, p, R{}, way.distance, way.distance - N(radius + N(o.radius)), time};
  }
};

template <class R>
struct StickPath {
  using N = typename tree::NumberOf<R>::Type;
  V3<R> a0, b0, a1, b1;
  N ra, rb;

  R travel() const { return squareRoot(larger(dot(a1 - a0, a1 - a0), dot(b1 - b0, b1 - b0))); }
  N thin() const { return ra < rb ? ra : rb; }
  /// Its axis is inside: the way out is another one.
  RAGDOLL_INLINE auto unclear(const Touch<R>& t) const {
    return less(t.distance, R{} + N(kInside));
  }
  /// As of a particle: of its ends, which move straight.
  RAGDOLL_INLINE R apart(const Solid& o, const Touch<R>& t) const {
    const auto least = [&t](const V3<R>& from, const V3<R>& to, N radius) {
      return smaller(dot(t.normal, from - t.at), dot(t.normal, to - t.at)) - radius;
    };
    return t.distance - N(o.radius) + smaller(least(a0, a1, ra), least(b0, b1, rb));
  }
  RAGDOLL_INLINE StickAxis<R> axis(const R& time) const {
    return stickAxis(a0 + time * (a1 - a0), b0 + time * (b1 - b0), ra, rb);
  }
  RAGDOLL_INLINE Touch<R> at(const Solid& o, const R& time) const {
    const StickAxis<R> k = axis(time);
    const NearestPlace<R> n = nearestPlace(k, o);
    const R share = N(1) / atLeast(n.distance, N(kOnCore));
    const R radius = R{} + N(k.radius) + N(k.taper) * n.at;
    return {
        share * n.excess, k.at(n.at), n.at, n.distance, n.distance - radius - N(o.radius), time};
  }
};

/// A solid as a pack sees it.
template <class R>
struct SolidPlace {
  V3<R> at0, at1;  ///< [m] from the lanes' origins
  V3<R> bound;     ///< [m] half of where something may touch it, in its frame
};

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
/// Adds a contact to the lanes where `here` is not 0.
template <class L>
RAGDOLL_SECTION void addContacts(const Solid& o, const SolidPlace<typename L::R>& s, int feature,
                                 const typename L::R& radius, const Touch<typename L::R>& t,
                                 const typename L::Mask& here, Lane* lanes) {
  using R = typename L::R;
  using N = typename L::N;
  const double* q = o.axes1;
  const V3<R>& n = t.normal;
  const V3<R> normal{N(q[0]) * n.x + N(q[3]) * n.y + N(q[6]) * n.z,
                     N(q[1]) * n.x + N(q[4]) * n.y + N(q[7]) * n.z,
                     N(q[2]) * n.x + N(q[5]) * n.y + N(q[8]) * n.z};
  const R depth = R{} + N(o.radius) - t.distance;  // of the surface behind `at`
  const R offset = dot(n, t.at) + depth + radius + dot(normal, s.at1);
  const R mine = select(here, R{} + N(1), R{});
  for (int l = 0; l < L::W; ++l) {
    Lane& to = lanes[l];
    if (lane(mine, l) == 0 || to.contact_count >= to.contact_room) continue;
    LaneContact& c = to.contacts[to.contact_count++];
    c = LaneContact();
    c.feature = feature;
    c.obstacle = o.obstacle;
    c.weight = lane(t.place, l);
    c.normal[0] = lane(normal.x, l);
    c.normal[1] = lane(normal.y, l);
    c.normal[2] = lane(normal.z, l);
    c.offset = lane(offset, l);
    c.friction = o.friction;
    c.restitution = o.restitution;
    if (!o.moves) continue;
    const double p[3] = {lane(t.at.x, l) + lane(depth, l) * lane(n.x, l),
                         lane(t.at.y, l) + lane(depth, l) * lane(n.y, l),
                         lane(t.at.z, l) + lane(depth, l) * lane(n.z, l)};
    for (int i = 0; i < 3; ++i) {
      c.motion[i] = o.place1[i] - o.place0[i];
      for (int k = 0; k < 3; ++k) c.motion[i] += (o.axes1[3 * k + i] - o.axes0[3 * k + i]) * p[k];
    }
  }
}

/// What the lanes where `here` is not 0 leave to contact/detect.h.
template <class L>
RAGDOLL_INLINE void leaveOver(int solid, int feature, const typename L::Mask& here, Lane* lanes) {
  using R = typename L::R;
  if (!any(here)) return;
  const R mine = select(here, R{} + typename L::N(1), R{});
  for (int l = 0; l < L::W; ++l) {
    Lane& to = lanes[l];
    if (lane(mine, l) == 0 || to.hard_count >= to.hard_room) continue;
    to.hard[to.hard_count++] = {feature, solid};
  }
}

template <class R>
RAGDOLL_INLINE auto isInner(const R& place) {
  using N = typename tree::NumberOf<R>::Type;
  return both(less(R{} + N(kStickTip), place), less(place, R{} + N(1 - kStickTip)));
}

/// Both ends of where a stick lies flat on a face, or where it is nearest.
template <class L>
RAGDOLL_INLINE void addStick(const Solid& o, const SolidPlace<typename L::R>& s, int feature,
                             const StickPath<typename L::R>& path, const Touch<typename L::R>& t,
                             typename L::Mask here, const typename L::R& margin, Lane* lanes) {
  using R = typename L::R;
  using N = typename L::N;
  const auto add = [&](const Touch<R>& touch, const typename L::Mask& where) {
    const auto mine = both(where, isInner(touch.place));
    if (!any(mine)) return;
    const R radius = R{} + path.ra + N(path.rb - path.ra) * touch.place;
    addContacts<L>(o, s, feature, radius, touch, mine, lanes);
  };
  if (o.is_box) {
    const StickAxis<R> k = path.axis(t.time);
    const R a[3] = {k.a.x, k.a.y, k.a.z}, v[3] = {k.v.x, k.v.y, k.v.z};
    const R rate[3] = {k.rate.x, k.rate.y, k.rate.z};
    const R n[3] = {t.normal.x, t.normal.y, t.normal.z};
    const R x = n[0] * n[0], y = n[1] * n[1], z = n[2] * n[2];
    const auto at_z = less(larger(x, y), z), at_y = less(x, y);
    const R one = R{} + N(1);
    R face[3];
    face[2] = select(at_z, signOf(n[2]), R{});
    face[1] = select(at_z, R{}, select(at_y, signOf(n[1]), R{}));
    face[0] = select(at_z, R{}, select(at_y, R{}, signOf(n[0])));
    R lo{}, hi = one, across{};
    R height = R{};
    for (int i = 0; i < 3; ++i) {
      const R b = (R{} - N(o.half[i]) - a[i]) * rate[i], c = (R{} + N(o.half[i]) - a[i]) * rate[i];
      const auto beside = less(face[i] * face[i], R{} + N(0.5));
      lo = select(beside, larger(lo, smaller(b, c)), lo);
      hi = select(beside, smaller(hi, larger(b, c)), hi);
      across += face[i] * v[i];
      height += face[i] * a[i] - face[i] * face[i] * N(o.half[i]);
    }
    const R wide = hi - lo, rise = (across - N(k.taper)) * wide;
    const auto flat =
        both(both(here, less(R{} + N(kStickTip), wide)), less(signOf(rise) * rise, R{} + N(kFlat)));
    if (any(flat)) {
      for (const R& place : {lo, hi}) {
        Touch<R> end = t;
        end.normal = {face[0], face[1], face[2]};
        end.place = place;
        end.at = k.at(place);
        end.distance = height + place * across;
        const R radius = R{} + N(k.radius) + N(k.taper) * place;
        add(end, both(flat, less(end.distance - radius, margin)));
      }
      here = both(here, less(R{}, select(flat, R{}, one)));
    }
  }
  add(t, here);
}

/// Looks at one particle or stick. near: lanes that come near the solid by their bounds.
template <class L, class Path, class Add>
RAGDOLL_INLINE void look(const Solid& o, int solid, int feature, const Path& path,
                         const typename L::Mask& near, const typename L::R& margin, Lane* lanes,
                         const Add& add) {
  using R = typename L::R;
  using N = typename L::N;
  const R none{}, one = R{} + N(1);
  const R travel = path.travel();
  Touch<R> touch = path.at(o, one);
  const R end = touch.gap;
  const auto fast = less(none + N(0.5) * path.thin(), travel);
  const auto sinks = both(near, less(end, none));
  auto passes = both(near, both(fast, less(end, travel)));
  if (any(passes)) passes = both(passes, less(path.apart(o, touch), none + N(kTouching)));
  const auto way = either(sinks, passes);
  auto here = both(near, less(end, margin)), hard = less(one, none);
  if (any(way)) {
    const Touch<R> begin = path.at(o, none);
    const R start = begin.gap;
    // Fast in touch at the start: with what it touches there.
    const auto opens = less(none + N(kTouching), start);
    const auto touches = both(less(none - path.thin(), start), less(start, none + N(kTouching)));
    const auto held = both(both(way, fast), touches);
    take(held, begin, touch);
    here = either(here, held);
    auto closes = both(both(way, opens), less(end, none - N(kLocated)));
    R lo = none, hi = one, open = start, shut = end;
    hard = both(both(passes, both(opens, less(none, end))),
                both(less(start + end, travel), less(path.apart(o, begin), none + N(kTouching))));
    if (any(hard)) {  // what comes and goes within the step
      const Touch<R> middle = path.at(o, none + N(0.5));
      const R clear = path.apart(o, middle);
      const auto dips = both(hard, less(middle.gap, none - N(kLocated)));
      closes = either(closes, dips);
      hi = select(dips, middle.time, hi);
      shut = select(dips, middle.gap, shut);
      hard =
          both(both(hard, less(none - N(kLocated), middle.gap)), less(clear, none + N(kTouching)));
      const auto grazes = both(hard, less(none - N(kGrazed), clear));
      take(grazes, middle, touch);
      here = either(here, grazes);
      hard = both(hard, less(clear, none - N(kGrazed)));
    }
    if (any(closes)) {
      const auto was_closing = closes;
      for (int round = 0; round < kLocations && any(closes); ++round) {
        const R chord = lo + (hi - lo) * open / atLeast(open - shut, N(kOnCore));
        const R safe = lo + open / atLeast(travel, N(kOnCore));
        const Touch<R> now = path.at(o, round == 0 ? select(fast, safe, chord) : chord);
        take(closes, now, touch);
        const auto still = less(none, now.gap);
        lo = select(still, now.time, lo);
        open = select(still, now.gap, open);
        hi = select(still, hi, now.time);
        shut = select(still, shut, now.gap);
        closes = both(closes, less(none + N(kLocated), signOf(now.gap) * now.gap));
      }
      hard = either(hard, both(was_closing, less(touch.gap, none - N(0.5) * path.thin())));
      here = either(here, was_closing);
    }
  }
  hard = either(hard, both(here, path.unclear(touch)));
  leaveOver<L>(solid, feature, hard, lanes);
  here = both(here, less(none, select(hard, none, one)));
  if (any(here)) add(touch, here);
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
RAGDOLL_INLINE auto isWithin(const V3<R>& low, const V3<R>& high, const V3<R>& bound) {
  const auto along = [](const R& lo, const R& hi, const R& most) {
    return both(less(lo, most), less(R{} - most, hi));
  };
  return both(along(low.x, high.x, bound.x),
              both(along(low.y, high.y, bound.y), along(low.z, high.z, bound.z)));
}
template <class R>
RAGDOLL_INLINE V3<R> smaller3(const V3<R>& a, const V3<R>& b) {
  return {smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z)};
}
template <class R>
RAGDOLL_INLINE V3<R> larger3(const V3<R>& a, const V3<R>& b) {
  return {larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z)};
}

/// Lower and upper corner of what a feature may reach, from its particles'.
template <class L>
RAGDOLL_INLINE auto comesNear(const Feature& f, const L& w, const V3<typename L::R>& bound) {
  const auto low = load3(w.low + 3 * f.a), high = load3(w.high + 3 * f.a);
  if (f.b < 0) return isWithin(low, high, bound);
  return isWithin(smaller3(low, load3(w.low + 3 * f.b)), larger3(high, load3(w.high + 3 * f.b)),
                  bound);
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

/// Contacts with solids that the free motion, from w.x by w.dx, comes near.
template <class L>
RAGDOLL_SECTION void findSolids(const FastBody& b, const PackStep& step, Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  if (step.solid_count == 0) return;
  const R margin =
      smaller(R{} + N(kMargin < kAside * step.h ? kMargin : kAside * step.h), w.margin);
  V3<R> centre, half;
  setBounds<L>(
      b, [&](int i) { return w.x + 3 * i; }, margin + w.travel, centre, half);
  for (int j = 0; j < step.solid_count; ++j) {
    const Solid& o = step.solids[j];
    SolidPlace<R> s;
    if (!isNear(o, w, centre, half, s)) continue;
    const R reach = margin + N(o.radius);
    s.bound = {reach + N(o.half[0]), reach + N(o.half[1]), reach + N(o.half[2])};
    for (int i = 0; i < b.particles; ++i) {
      const V3<R> x = load3(w.x + 3 * i);
      const V3<R> here = intoFrame(o.axes0, x - s.at0);
      const V3<R> there = intoFrame(o.axes1, (x - s.at1) + load3(w.dx + 3 * i));
      store3(here, w.here + 3 * i);
      store3(there, w.there + 3 * i);
      const R r = R{} + N(b.features[i].radius[0]);
      store3(smaller3(here, there) - V3<R>{r, r, r}, w.low + 3 * i);
      store3(larger3(here, there) + V3<R>{r, r, r}, w.high + 3 * i);
    }
    for (std::size_t f = 0; f < b.features.size(); ++f) {
      const Feature& k = b.features[f];
      const auto near = comesNear(k, w, s.bound);
      if (!any(near) || isHeld(b, w, k)) continue;
      const int feature = static_cast<int>(f);
      if (k.b < 0) {
        const ParticlePath<R> path{load3(w.here + 3 * k.a), load3(w.there + 3 * k.a),
                                   N(k.radius[0])};
        look<L>(o, j, feature, path, near, margin, lanes,
                [&](const Touch<R>& t, const typename L::Mask& here) {
                  addContacts<L>(o, s, feature, R{} + path.radius, t, here, lanes);
                });
      } else {
        const StickPath<R> path{load3(w.here + 3 * k.a),  load3(w.here + 3 * k.b),
                                load3(w.there + 3 * k.a), load3(w.there + 3 * k.b),
                                N(k.radius[0]),           N(k.radius[1])};
        look<L>(o, j, feature, path, near, margin, lanes,
                [&](const Touch<R>& t, const typename L::Mask& here) {
                  addStick<L>(o, s, feature, path, t, here, margin, lanes);
                });
      }
    }
  }
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
      b, [&](int i) { return w.x + 3 * i; }, R{} - N(kMostDeep), centre, half);
  R depth{};  // beyond what is allowed
  for (int j = 0; j < step.solid_count; ++j) {
    const Solid& o = step.solids[j];
    SolidPlace<R> s;
    if (!isNear(o, w, centre, half, s)) continue;
    const R reach = R{} + N(o.radius - kMostDeep);
    s.bound = {reach + N(o.half[0]), reach + N(o.half[1]), reach + N(o.half[2])};
    for (int i = 0; i < b.particles; ++i) {
      const V3<R> there = intoFrame(o.axes1, load3(w.x + 3 * i) - s.at1);
      store3(there, w.there + 3 * i);
      const R r = R{} + N(b.features[i].radius[0]);
      store3(there - V3<R>{r, r, r}, w.low + 3 * i);
      store3(there + V3<R>{r, r, r}, w.high + 3 * i);
    }
    for (const Feature& k : b.features) {
      const auto near = comesNear(k, w, s.bound);
      if (!any(near) || isHeld(b, w, k)) continue;
      R deep;
      if (k.b < 0) {
        const Way<R> way = wayTo(load3(w.there + 3 * k.a), o);
        deep = N(k.radius[0] + o.radius - kMostDeep) - way.distance;
      } else {
        const StickAxis<R> axis = stickAxis(load3(w.there + 3 * k.a), load3(w.there + 3 * k.b),
                                            N(k.radius[0]), N(k.radius[1]));
        const NearestPlace<R> n = nearestPlace(axis, o);
        deep = N(axis.radius + N(o.radius - kMostStickDeep)) + axis.taper * n.at - n.distance;
      }
      depth = larger(depth, select(near, deep, R{}));
    }
  }
  for (int l = 0; l < L::W; ++l) lanes[l].deep = lane(depth, l) > 0;
}

}  // namespace ragdoll::fast
