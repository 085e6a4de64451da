// How far particles and sticks are from a solid, in the solid's frame: an obstacle but a plane is
// what is within a radius of a core, a box, a line or a point. No branch but on whether any lane
// needs a part, so that a lane's bits do not depend on its neighbours. docs/fast.md#search.
#pragma once

#include "core/fast/border.h"
#include "core/fast/pack.h"

namespace ragdoll::fast {

using tree::V3;

template <class R>
RAGDOLL_INLINE R smaller(const R& a, const R& b) {
  return select(less(a, b), a, b);
}

/// From the core, of one coordinate; 0 inside.
template <class R, class N>
RAGDOLL_INLINE R excess(const R& a, N half) {
  return larger(a - half, R{}) + select(less(a + half, R{}), a + half, R{});
}
template <class R>
RAGDOLL_INLINE V3<R> excess(const V3<R>& a, const Solid& o) {
  using N = typename tree::NumberOf<R>::Type;
  return {excess(a.x, N(o.half[0])), excess(a.y, N(o.half[1])), excess(a.z, N(o.half[2]))};
}

/// The way from the core to a place.
template <class R>
struct Way {
  V3<R> normal;
  R distance;  ///< [m] negative: inside, of the nearest face
};

template <class R>
RAGDOLL_INLINE Way<R> wayTo(const V3<R>& p, const Solid& o) {
  using N = typename tree::NumberOf<R>::Type;
  const V3<R> e = excess(p, o);
  const R length = squareRoot(dot(e, e));
  const R share = N(1) / atLeast(length, N(kOnCore));
  Way<R> way{share * e, length};
  const auto inside = less(length, R{} + N(kOnCore));
  if (!any(inside)) return way;
  const R q[3] = {signOf(p.x) * p.x - N(o.half[0]), signOf(p.y) * p.y - N(o.half[1]),
                  signOf(p.z) * p.z - N(o.half[2])};
  const R most = larger(larger(q[0], q[1]), q[2]);
  const auto at_z = less(larger(q[0], q[1]), q[2]), at_y = less(q[0], q[1]);
  const R z = select(at_z, signOf(p.z), R{});
  const R y = select(at_z, R{}, select(at_y, signOf(p.y), R{}));
  const R x = select(at_z, R{}, select(at_y, R{}, signOf(p.x)));
  way.normal = {select(inside, x, way.normal.x), select(inside, y, way.normal.y),
                select(inside, z, way.normal.z)};
  way.distance = select(inside, select(less(most, R{}), most, R{}), length);
  return way;
}

/// A stick in a solid's frame, from a to a + v; its radius grows by `taper` along it.
template <class R>
struct StickAxis {
  V3<R> a, v;
  V3<R> rate;       ///< 1 / v
  R radius, taper;  ///< [m]

  V3<R> at(const R& t) const { return a + t * v; }
};

template <class R>
RAGDOLL_INLINE R inverseOf(const R& a) {
  using N = typename tree::NumberOf<R>::Type;
  const R sign = signOf(a);
  return sign / atLeast(sign * a, N(kOnCore));
}

template <class R>
RAGDOLL_INLINE StickAxis<R> stickAxis(const V3<R>& a, const V3<R>& b, const R& radius_a,
                                      const R& radius_b) {
  const V3<R> v = b - a;
  return {a, v, {inverseOf(v.x), inverseOf(v.y), inverseOf(v.z)}, radius_a, radius_b - radius_a};
}

/// Where a stick is nearest, in [0, 1], exactly but for what taper turns it by in a piece between
/// two faces' planes: there distance^2's slope along the stick is linear, and it grows all along.
template <class R>
struct NearestPlace {
  R at;
  V3<R> excess;
  R distance;  ///< [m] of the axis from the core
};

template <class R>
struct Slope {
  R half;   ///< of distance^2 along the stick, halved
  R span2;  ///< distance^2
};

template <class R>
RAGDOLL_INLINE Slope<R> slopeAt(const StickAxis<R>& k, const Solid& o, const R& t) {
  const V3<R> e = excess(k.at(t), o);
  return {dot(k.v, e), dot(e, e)};
}

/// Whether the gap shrinks from there on.
template <class R>
RAGDOLL_INLINE auto shrinks(const StickAxis<R>& k, const Slope<R>& s) {
  using N = typename tree::NumberOf<R>::Type;
  const R taper2 = k.taper * (signOf(k.taper) * k.taper);
  return less(s.half * (signOf(s.half) * s.half), taper2 * s.span2 + N(kOnCore * kOnCore));
}

template <class R>
RAGDOLL_INLINE NearestPlace<R> nearestPlace(const StickAxis<R>& k, const Solid& o) {
  using N = typename tree::NumberOf<R>::Type;
  const R one = R{} + N(1);
  R lo{}, hi = one;
  Slope<R> low = slopeAt(k, o, lo), high = slopeAt(k, o, hi);
  const auto begins = shrinks(k, low), ends = shrinks(k, high);
  const R* const a[3] = {&k.a.x, &k.a.y, &k.a.z};
  const R* const slope[3] = {&k.rate.x, &k.rate.y, &k.rate.z};
  for (int i = 0; i < 3; ++i)
    for (int side = -1; side < 2; side += 2) {
      const R t = (R{} + N(side * o.half[i]) - *a[i]) * *slope[i];
      const auto within = both(less(lo, t), less(t, hi));
      if (!any(within)) continue;
      const Slope<R> s = slopeAt(k, o, t);
      const auto on = shrinks(k, s), up = both(within, on);
      lo = select(up, t, lo);
      low.half = select(up, s.half, low.half);
      low.span2 = select(up, s.span2, low.span2);
      const R top = select(on, hi, t);
      hi = select(within, top, hi);
      high.half = select(within, select(on, high.half, s.half), high.half);
    }
  const R rate = one / atLeast(high.half - low.half, N(kOnCore * kOnCore));
  R span2 = low.span2, t{};
  const bool tapers = any(either(less(R{}, k.taper), less(k.taper, R{})));
  for (int i = 0; i < (tapers ? 2 : 1); ++i) {  // its distance there is not known at first
    const R share = (k.taper * squareRoot(span2) - low.half) * rate;
    t = lo + (hi - lo) * select(less(share, one), atLeast(share, N(0)), one);
    const V3<R> e = excess(k.at(t), o);
    span2 = dot(e, e);
  }
  t = select(begins, select(ends, one, t), R{});
  NearestPlace<R> out;
  out.at = t;
  out.excess = excess(k.at(t), o);
  out.distance = squareRoot(dot(out.excess, out.excess));
  return out;
}

}  // namespace ragdoll::fast
