// Directions that links carry, and what limits are of them: values by cosines, gradients as
// torques. No trigonometry. Geometry: limit.h; docs/fast.md#limits.
#pragma once

#include "core/fast/lane_work.h"

namespace ragdoll::fast {

/// [-] As kMinSwing of direction.h.
constexpr double kLeastSwing = 1e-6;

/// A vector fixed in a link, at the start of the step or where it is now.
template <bool moved, class L>
RAGDOLL_INLINE V3<typename L::R> carried(const FastBody& b, const L& w, int link, const double* c) {
  using N = typename L::N;
  const auto* axes = w.tree.axes + 9 * link;
  const auto* turn = w.tree.turn + 9 * link;
  if (b.tree.links[link].kind == TreeLink::Kind::kPointer) {
    auto u = load3(axes);
    if (moved) u = u + load3(turn);
    return N(c[0]) * u;
  }
  const auto d = N(c[0]) * load3(axes) + N(c[1]) * load3(axes + 3) + N(c[2]) * load3(axes + 6);
  return moved ? d + tree::multiply(turn, d) : d;
}

/// v turned by the smallest rotation from a to u (direction.h).
template <class R>
RAGDOLL_INLINE V3<R> swungBy(const V3<R>& a, const V3<R>& u, const V3<R>& v) {
  using N = typename tree::NumberOf<R>::Type;
  const V3<R> s = a + u;
  const R k = N(1) / atLeast(N(1) + dot(a, u), N(kLeastSwing));
  return v - (k * dot(s, v)) * s + (N(2) * dot(a, v)) * u;
}

template <bool moved, class L>
RAGDOLL_INLINE V3<typename L::R> directionOf(const FastBody& b, const L& w,
                                             const CarriedDirection& d, int swings,
                                             const double* c) {
  V3<typename L::R> v = carried<moved>(b, w, d.base.link, c);
  if (swings == 0) return v;
  V3<typename L::R> a = carried<moved>(b, w, d.base.link, d.swing[0].axis);
  const auto u0 = carried<moved>(b, w, d.swing[0].bone.link, d.swing[0].bone.c);
  const auto first = swungBy(a, u0, v);
  if (swings == 1) return first;
  const auto axis = swungBy(a, u0, carried<moved>(b, w, d.base.link, d.swing[1].axis));
  const auto u1 = carried<moved>(b, w, d.swing[1].bone.link, d.swing[1].bone.c);
  return swungBy(axis, u1, first);
}

template <bool moved, class L>
RAGDOLL_INLINE V3<typename L::R> directionOf(const FastBody& b, const L& w,
                                             const CarriedDirection& d) {
  return directionOf<moved>(b, w, d, d.swings, d.base.c);
}

/// A limit's child as its reference's base sees it, before that is swung: limits of one joint share
/// it.
template <class R>
struct SeenChild {
  int group = -1;  ///< FastLimit::group
  V3<R> d{};       ///< along the base's axes; pointer: along it alone
};

template <bool moved, class L>
RAGDOLL_INLINE void seeChild(const FastBody& b, const L& w, const FastLimit& limit,
                             SeenChild<typename L::R>& seen) {
  using R = typename L::R;
  const CarriedDirection& r = limit.reference;
  const int link = r.base.link;
  seen.group = limit.group;
  V3<R> d = directionOf<moved>(b, w, limit.child);
  if (r.swings > 0)  // back from where the bone has swung its axis
    d = swungBy(carried<moved>(b, w, r.swing[0].bone.link, r.swing[0].bone.c),
                carried<moved>(b, w, link, r.swing[0].axis), d);
  const R* axes = w.tree.axes + 9 * link;
  const R* turn = w.tree.turn + 9 * link;
  if (b.tree.links[link].kind == TreeLink::Kind::kPointer) {
    seen.d.x = dot(moved ? load3(axes) + load3(turn) : load3(axes), d);
    return;
  }
  if (moved)
    d = d + V3<R>{turn[0] * d.x + turn[3] * d.y + turn[6] * d.z,
                  turn[1] * d.x + turn[4] * d.y + turn[7] * d.z,
                  turn[2] * d.x + turn[5] * d.y + turn[8] * d.z};
  seen.d = {dot(load3(axes), d), dot(load3(axes + 3), d), dot(load3(axes + 6), d)};
}

/// [rad] C of the limit near its border; away from it, of the same sign. seen: of the limit before.
template <bool moved, class L>
RAGDOLL_INLINE typename L::R limitValue(const FastBody& b, const L& w, const FastLimit& limit,
                                        SeenChild<typename L::R>& seen) {
  using R = typename L::R;
  using N = typename L::N;
  const CarriedDirection& r = limit.reference;
  if (r.swings > 1 || limit.turn) {
    const auto d = directionOf<moved>(b, w, limit.child);
    const R c = dot(directionOf<moved>(b, w, r), d);
    if (!limit.turn) return N(limit.scale) * (c - N(limit.cos_angle));
    const R s = dot(directionOf<moved>(b, w, limit.normal), d);
    return N(limit.sin_angle) * c - N(limit.cos_angle) * (signOf(s) * s);
  }
  if (seen.group != limit.group) seeChild<moved>(b, w, limit, seen);
  R c = N(r.base.c[0]) * seen.d.x;
  if (b.tree.links[r.base.link].kind != TreeLink::Kind::kPointer)
    c += N(r.base.c[1]) * seen.d.y + N(r.base.c[2]) * seen.d.z;
  return N(limit.scale) * (c - N(limit.cos_angle));
}

/// Of all limits, or of rows, one after the other.
template <bool moved, class L>
RAGDOLL_SECTION typename L::R valueOf(const FastBody& b, const L& w, const FastLimit& limit,
                                      SeenChild<typename L::R>& seen) {
  return limitValue<moved>(b, w, limit, seen);
}

/// Adds to w.row what a function has of the coordinates that turn a link, by torque on it.
template <class L>
RAGDOLL_INLINE void addTorque(const FastBody& b, L& w, int link, V3<typename L::R> torque) {
  const TreeLink* k = &b.tree.links[link];
  while (k->kind == TreeLink::Kind::kFold) {
    w.row[k->first] += dot(load3(w.tree.axes + 9 * link), torque);
    link = k->parent;
    k = &b.tree.links[link];
  }
  typename L::R* to = w.row + k->first;
  store3(load3(to) + torque, to);
}

/// Adds the gradient of a function whose derivative with respect to a link's vector is g.
template <class L>
RAGDOLL_INLINE void addGradient(const FastBody& b, L& w, int link, const double* c,
                                const V3<typename L::R>& g) {
  using N = typename L::N;
  const TreeLink& k = b.tree.links[link];
  if (k.kind != TreeLink::Kind::kPointer)
    return addTorque(b, w, link, cross(carried<false>(b, w, link, c), g));
  w.row[k.first] += N(c[0]) * dot(load3(w.tree.axes + 9 * link + 3), g);
  w.row[k.first + 1] += N(c[0]) * dot(load3(w.tree.axes + 9 * link + 6), g);
}

/// Derivatives of g . swungBy(a, u, v) with respect to a, u and v.
template <class R>
struct SwingGradient {
  V3<R> a, u, v;
};

template <class R>
RAGDOLL_INLINE SwingGradient<R> gradientOf(const V3<R>& a, const V3<R>& u, const V3<R>& v,
                                           const V3<R>& g) {
  using N = typename tree::NumberOf<R>::Type;
  const V3<R> s = a + u;
  const R divisor = N(1) + dot(a, u);
  const R k = N(1) / atLeast(divisor, N(kLeastSwing));
  const R sv = dot(s, v), sg = dot(s, g);
  const V3<R> on_s = (-k) * (sg * v + sv * g);
  const R on_divisor = select(less(R{} + N(kLeastSwing), divisor), k * k * sv * sg, R{});
  return {on_s + on_divisor * u + (N(2) * dot(g, u)) * v,
          on_s + on_divisor * a + (N(2) * dot(a, v)) * g,
          g - (k * sg) * s + (N(2) * dot(g, u)) * a};
}

template <class L>
RAGDOLL_INLINE void addCarried(const FastBody& b, L& w, const CarriedDirection& d, int swings,
                               const double* c, const V3<typename L::R>& g) {
  if (swings == 0) return addGradient(b, w, d.base.link, c, g);
  const auto& swing = d.swing[swings - 1];
  const auto a = directionOf<false>(b, w, d, swings - 1, swing.axis);
  const auto v = directionOf<false>(b, w, d, swings - 1, c);
  const auto u = carried<false>(b, w, swing.bone.link, swing.bone.c);
  const auto on = gradientOf(a, u, v, g);
  if (swings == 2) {
    addSwung(b, w, d, swing.axis, on.a);
    addSwung(b, w, d, c, on.v);
  } else {
    addGradient(b, w, d.base.link, swing.axis, on.a);
    addGradient(b, w, d.base.link, c, on.v);
  }
  addGradient(b, w, swing.bone.link, swing.bone.c, on.u);
}

/// The same through the first swing alone.
template <class L>
RAGDOLL_INLINE void addSwung(const FastBody& b, L& w, const CarriedDirection& d, const double* c,
                             const V3<typename L::R>& g) {
  const auto& swing = d.swing[0];
  const auto a = carried<false>(b, w, d.base.link, swing.axis);
  const auto v = carried<false>(b, w, d.base.link, c);
  const auto u = carried<false>(b, w, swing.bone.link, swing.bone.c);
  const auto on = gradientOf(a, u, v, g);
  addGradient(b, w, d.base.link, swing.axis, on.a);
  addGradient(b, w, d.base.link, c, on.v);
  addGradient(b, w, swing.bone.link, swing.bone.c, on.u);
}

/// dC / d coordinates, into w.row.
template <class L>
RAGDOLL_INLINE void setGradient(const FastBody& b, L& w, const FastLimit& limit) {
  using N = typename L::N;
  for (const int k : limit.row.index) w.row[k] = typename L::R{};
  const auto r = directionOf<false>(b, w, limit.reference);
  const auto d = directionOf<false>(b, w, limit.child);
  const auto add = [&](const CarriedDirection& to, const V3<typename L::R>& g) {
    addCarried(b, w, to, to.swings, to.base.c, g);
  };
  if (!limit.turn) {
    add(limit.child, N(limit.scale) * r);
    add(limit.reference, N(limit.scale) * d);
    return;
  }
  const auto n = directionOf<false>(b, w, limit.normal);
  const auto side = N(-limit.cos_angle) * signOf(dot(n, d));
  add(limit.child, N(limit.sin_angle) * r + side * n);
  add(limit.reference, N(limit.sin_angle) * d);
  add(limit.normal, side * d);
}

}  // namespace ragdoll::fast
