// When and where particles and sticks near a solid touch it in a step: contacts of their lanes. As
// contact/detect.h, but that a first touch is located to millimetres and that what is left over
// goes there. docs/fast.md#search.
#pragma once

#include "core/fast/lane_pairs.h"

namespace ragdoll::fast {

/// Where particles or sticks touch, one of each pair: what becomes a contact in `lanes`.
template <class R>
struct Found {
  Touch<R> touch;
  R radius;            ///< [m] of the body there
  unsigned pairs = 0;  ///< a bit each
};

/// [m] of the surface at `at` during the step, in the world.
inline void setMotion(const Solid& o, const double* at, double* motion) {
  for (int i = 0; i < 3; ++i) {
    motion[i] = o.place1[i] - o.place0[i];
    for (int k = 0; k < 3; ++k) motion[i] += (o.axes1[3 * k + i] - o.axes0[3 * k + i]) * at[k];
  }
}

/// Contacts of one place each.
template <class L>
struct WorldPlace {
  using R = typename L::R;
  using N = typename L::N;
  V3<R> normal;
  R depth, offset;  ///< [m] of the surface behind `at`; along the normal, from the lanes' origins

  RAGDOLL_INLINE WorldPlace() = default;
  RAGDOLL_INLINE WorldPlace(const Solid& o, const PairBatch<L>& batch, const Found<R>& found) {
    const double* q = o.axes1;
    const Touch<R>& t = found.touch;
    const V3<R>& n = t.normal;
    normal = {N(q[0]) * n.x + N(q[3]) * n.y + N(q[6]) * n.z,
              N(q[1]) * n.x + N(q[4]) * n.y + N(q[7]) * n.z,
              N(q[2]) * n.x + N(q[5]) * n.y + N(q[8]) * n.z};
    depth = R{} + N(o.radius) - t.distance;
    offset = dot(n, t.at) + depth + found.radius + dot(normal, batch.at1);
  }
  RAGDOLL_INLINE void write(const Solid& o, const Touch<R>& t, int i, LaneContact& c) const {
    c.obstacle = o.obstacle;
    c.weight = lane(t.place, i);
    c.normal[0] = lane(normal.x, i);
    c.normal[1] = lane(normal.y, i);
    c.normal[2] = lane(normal.z, i);
    c.offset = lane(offset, i);
    c.friction = o.friction;
    c.restitution = o.restitution;
    if (!o.moves) return;
    const double behind = lane(depth, i);
    const double at[3] = {lane(t.at.x, i) + behind * lane(t.normal.x, i),
                          lane(t.at.y, i) + behind * lane(t.normal.y, i),
                          lane(t.at.z, i) + behind * lane(t.normal.z, i)};
    setMotion(o, at, c.motion);
  }
};

/// Adds what was found, pair by pair: a lane's order depends on its own pairs alone.
template <int count, class L>
RAGDOLL_SECTION void addContacts(const Solid& o, const PairBatch<L>& batch,
                                 const Found<typename L::R>* found, Lane* lanes) {
  unsigned all = 0;
  WorldPlace<L> places[count];
  for (int k = 0; k < count; ++k) {
    if (found[k].pairs != 0) places[k] = WorldPlace<L>(o, batch, found[k]);
    all |= found[k].pairs;
  }
  for (int i = 0; all >> i != 0; ++i)
    for (int k = 0; k < count; ++k) {
      if (!(found[k].pairs >> i & 1)) continue;
      Lane& to = lanes[batch.pairs[i].lane];
      if (to.contact_count >= to.contact_room) continue;
      LaneContact& c = to.contacts[to.contact_count++];
      c = LaneContact();
      c.feature = batch.pairs[i].feature;
      places[k].write(o, found[k].touch, i, c);
    }
}

/// What the pairs where `here` is true leave to contact/detect.h.
template <class L>
RAGDOLL_INLINE void leaveOver(int solid, const PairBatch<L>& batch, const typename L::Mask& here,
                              Lane* lanes) {
  const unsigned mine = lanesOf(here);
  for (int i = 0; mine >> i != 0; ++i) {
    Lane& to = lanes[batch.pairs[i].lane];
    if (!(mine >> i & 1) || to.hard_count >= to.hard_room) continue;
    to.hard[to.hard_count++] = {batch.pairs[i].feature, solid};
  }
}

template <class R>
RAGDOLL_INLINE auto isInner(const R& place) {
  using N = typename tree::NumberOf<R>::Type;
  return both(less(R{} + N(kStickTip), place), less(place, R{} + N(1 - kStickTip)));
}

/// Where a stick in a box's frame lies over the face that it is nearest to.
template <class R>
struct OverFace {
  V3<R> normal;
  R lo{}, hi;        ///< shares of the stick
  R height, across;  ///< [m] of its axis over the face, at its start; what it rises by
};

template <class R>
RAGDOLL_INLINE OverFace<R> overFace(const Solid& o, const StickAxis<R>& k, const V3<R>& normal) {
  using N = typename tree::NumberOf<R>::Type;
  const R a[3] = {k.a.x, k.a.y, k.a.z}, v[3] = {k.v.x, k.v.y, k.v.z};
  const R rate[3] = {k.rate.x, k.rate.y, k.rate.z};
  const R n[3] = {normal.x, normal.y, normal.z};
  const R x = n[0] * n[0], y = n[1] * n[1], z = n[2] * n[2];
  const auto at_z = less(larger(x, y), z), at_y = less(x, y);
  R face[3];
  face[2] = select(at_z, signOf(n[2]), R{});
  face[1] = select(at_z, R{}, select(at_y, signOf(n[1]), R{}));
  face[0] = select(at_z, R{}, select(at_y, R{}, signOf(n[0])));
  OverFace<R> over{{face[0], face[1], face[2]}, R{}, R{} + N(1), R{}, R{}};
  for (int i = 0; i < 3; ++i) {
    const R b = (R{} - N(o.half[i]) - a[i]) * rate[i], c = (R{} + N(o.half[i]) - a[i]) * rate[i];
    const auto beside = less(face[i] * face[i], R{} + N(0.5));
    over.lo = select(beside, larger(over.lo, smaller(b, c)), over.lo);
    over.hi = select(beside, smaller(over.hi, larger(b, c)), over.hi);
    over.across += face[i] * v[i];
    over.height += face[i] * a[i] - face[i] * face[i] * N(o.half[i]);
  }
  return over;
}

/// Both ends of where a stick lies flat on a face, or where it is nearest.
template <class L>
RAGDOLL_INLINE void addTouches(const Solid& o, const PairBatch<L>& batch,
                               const StickPath<typename L::R>& path, const Touch<typename L::R>& t,
                               typename L::Mask here, Lane* lanes) {
  using R = typename L::R;
  using N = typename L::N;
  Found<R> found[3];
  const auto set = [&](const Touch<R>& touch, const typename L::Mask& where, Found<R>& to) {
    to = {touch, path.ra + (path.rb - path.ra) * touch.place,
          lanesOf(both(where, isInner(touch.place)))};
  };
  if (o.is_box) {
    const StickAxis<R> k = path.axis(t.time);
    const OverFace<R> over = overFace(o, k, t.normal);
    const R wide = over.hi - over.lo, rise = (over.across - k.taper) * wide;
    const auto flat =
        both(both(here, less(R{} + N(kStickTip), wide)), less(signOf(rise) * rise, R{} + N(kFlat)));
    if (any(flat)) {
      for (int e = 0; e < 2; ++e) {
        Touch<R> end = t;
        end.normal = over.normal;
        end.place = e == 0 ? over.lo : over.hi;
        end.at = k.at(end.place);
        end.distance = over.height + end.place * over.across;
        take(e == 0 ? less(t.place, over.lo) : less(over.hi, t.place), t, end);  // over an edge
        const R radius = k.radius + k.taper * end.place;
        set(end, both(flat, less(end.distance - radius, batch.margin)), found[e]);
      }
      here = both(here, less(R{}, select(flat, R{}, R{} + N(1))));
    }
  }
  set(t, here, found[2]);
  addContacts<3>(o, batch, found, lanes);
}

template <class L>
RAGDOLL_INLINE void addTouches(const Solid& o, const PairBatch<L>& batch,
                               const ParticlePath<typename L::R>& path,
                               const Touch<typename L::R>& t, const typename L::Mask& here,
                               Lane* lanes) {
  const Found<typename L::R> found{t, path.radius, lanesOf(here)};
  addContacts<1>(o, batch, &found, lanes);
}

/// Looks at a batch of particles or sticks.
template <class L, class Path>
RAGDOLL_SECTION void look(const Solid& o, int solid, const PairBatch<L>& batch, const Path& path,
                          Lane* lanes) {
  using R = typename L::R;
  using N = typename L::N;
  const R none{}, one = R{} + N(1);
  const auto near = batch.mask;
  const R margin = batch.margin, travel = path.travel();
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
  leaveOver(solid, batch, hard, lanes);
  here = both(here, less(none, select(hard, none, one)));
  if (any(here)) addTouches(o, batch, path, touch, here, lanes);
}

}  // namespace ragdoll::fast
