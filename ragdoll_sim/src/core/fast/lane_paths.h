// Paths of particles and sticks past a solid in a step, in its frame. docs/fast.md#search.
#pragma once

#include "core/fast/lane_distance.h"

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
  R radius;  ///< [m]

  R travel() const { return squareRoot(dot(to - from, to - from)); }
  R thin() const { return radius; }
  RAGDOLL_INLINE auto unclear(const Touch<R>& t) const { return less(t.time, R{} - N(1)); }
  /// [m] Least gap on the way to the plane between it and the solid as found: the solid is no
  /// nearer.
  RAGDOLL_INLINE R apart(const Solid&, const Touch<R>& t) const {
    return t.gap + smaller(dot(t.normal, from - t.at), dot(t.normal, to - t.at));
  }
  RAGDOLL_INLINE Touch<R> at(const Solid& o, const R& time) const {
    const V3<R> p = from + time * (to - from);
    const Way<R> way = wayTo(p, o);
    return {way.normal, p, R{}, way.distance, way.distance - (radius + N(o.radius)), time};
  }
};

template <class R>
struct StickPath {
  using N = typename tree::NumberOf<R>::Type;
  V3<R> a0, b0, a1, b1;
  R ra, rb;  ///< [m] of its ends

  R travel() const { return squareRoot(larger(dot(a1 - a0, a1 - a0), dot(b1 - b0, b1 - b0))); }
  R thin() const { return smaller(ra, rb); }
  /// Its axis is inside: the way out is another one.
  RAGDOLL_INLINE auto unclear(const Touch<R>& t) const {
    return less(t.distance, R{} + N(kInside));
  }
  /// As of a particle: of its ends, which move straight.
  RAGDOLL_INLINE R apart(const Solid& o, const Touch<R>& t) const {
    const auto least = [&t](const V3<R>& from, const V3<R>& to, const R& radius) {
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
    const R radius = k.radius + k.taper * n.at;
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

}  // namespace ragdoll::fast
