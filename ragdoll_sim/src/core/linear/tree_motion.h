// A tree's motions: momenta by its coordinates, and the pose that these lead to (tree_kernels.h).
// docs/fast.md#tree.
#pragma once

#include "core/linear/tree_kernels.h"

namespace ragdoll::tree {

/// out (size) = T^T of forces on the particles, which it takes from w.force and uses up.
template <class R>
RAGDOLL_INLINE void gather(const Tree& t, Work<R>& w, R* out) {
  using N = typename NumberOf<R>::Type;
  for (std::size_t j = 0; j < t.links.size(); ++j) store3(V3<R>{}, w.torque + 3 * j);
  for (std::size_t j = t.links.size(); j-- > 0;) {
    const TreeLink& k = t.links[j];
    const R* axes = w.axes + 9 * j;
    V3<R> sum{}, l{};
    for (int i = k.points_begin; i < k.points_end; ++i) {
      const V3<R> f = load3(w.force + 3 * t.points[i].particle);
      sum = sum + f;
      l = l + (k.kind == TreeLink::Kind::kPointer ? N(t.points[i].at[0]) * f
                                                  : cross(load3(w.lever + 3 * i), f));
    }
    R* attach = w.force + 3 * k.attach;
    store3(load3(attach) + sum, attach);
    if (k.kind == TreeLink::Kind::kPointer) {
      out[k.first] = dot(load3(axes + 3), l);
      out[k.first + 1] = dot(load3(axes + 6), l);
      continue;
    }
    l = l + load3(w.torque + 3 * j);
    if (k.kind == TreeLink::Kind::kTurn) {
      store3(l, out + k.first);
    } else {
      out[k.first] = dot(load3(axes), l);
      store3(load3(w.torque + 3 * k.parent) + l, w.torque + 3 * k.parent);
    }
  }
  for (const TreeRoot& root : t.roots)
    if (!root.pinned) store3(load3(w.force + 3 * root.particle), out + root.first);
}

/// Of one particle: a row of M dx.
template <class R>
RAGDOLL_INLINE V3<R> momentumOf(const Tree& t, int particle, const R* dx) {
  using N = typename NumberOf<R>::Type;
  V3<R> sum{};
  for (int i = t.mass_begin[particle]; i < t.mass_begin[particle + 1]; ++i)
    sum = sum + N(t.masses[i].value) * load3(dx + 3 * t.masses[i].column);
  return sum;
}

/// w.force = M dx, momentum in units of dx.
template <class R>
RAGDOLL_INLINE void momentum(const Tree& t, const R* dx, Work<R>& w) {
  for (int i = 0; i < t.particles; ++i) store3(momentumOf(t, i, dx), w.force + 3 * i);
}

/// dx = T q. turn: 3 per link, scratch (w.torque).
template <class R>
RAGDOLL_INLINE void move(const Tree& t, Work<R>& w, const R* q, R* dx) {
  using N = typename NumberOf<R>::Type;
  for (const TreeRoot& root : t.roots)
    store3(root.pinned ? V3<R>{} : load3(q + root.first), dx + 3 * root.particle);
  for (std::size_t j = 0; j < t.links.size(); ++j) {
    const TreeLink& k = t.links[j];
    const R* axes = w.axes + 9 * j;
    const V3<R> o = load3(dx + 3 * k.attach);
    V3<R> turn;
    if (k.kind == TreeLink::Kind::kPointer)
      turn = q[k.first] * load3(axes + 3) + q[k.first + 1] * load3(axes + 6);
    else if (k.kind == TreeLink::Kind::kTurn)
      turn = load3(q + k.first);
    else
      turn = load3(w.torque + 3 * k.parent) + q[k.first] * load3(axes);
    store3(turn, w.torque + 3 * j);
    for (int i = k.points_begin; i < k.points_end; ++i)
      store3(o + (k.kind == TreeLink::Kind::kPointer ? N(t.points[i].at[0]) * turn
                                                     : cross(turn, load3(w.lever + 3 * i))),
             dx + 3 * t.points[i].particle);
  }
}

/// 3 x 3, row by row.
template <class R>
RAGDOLL_INLINE V3<R> multiply(const R* m, const V3<R>& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
          m[6] * v.x + m[7] * v.y + m[8] * v.z};
}

/// Rotation less identity, from the vector axis times sine: Rodrigues' formula without angles.
/// off: the largest squared sine of all, above 1 there is none.
template <class R>
RAGDOLL_INLINE void rotation(const V3<R>& s, R* m, R& off) {
  using N = typename NumberOf<R>::Type;
  const R s2 = dot(s, s);
  off = larger(s2, off);
  const R g = N(1) / (N(1) + squareRoot(atLeast(N(1) - s2, N(0))));
  m[0] = -g * (s.y * s.y + s.z * s.z);
  m[4] = -g * (s.x * s.x + s.z * s.z);
  m[8] = -g * (s.x * s.x + s.y * s.y);
  const R xy = g * s.x * s.y, xz = g * s.x * s.z, yz = g * s.y * s.z;
  m[1] = xy - s.z;
  m[3] = xy + s.z;
  m[2] = xz + s.y;
  m[6] = xz - s.y;
  m[5] = yz - s.x;
  m[7] = yz + s.x;
}

/// a <- a + b + a b: what follows when b turns first.
template <class R>
RAGDOLL_INLINE void compose(const R* first, const R* then, R* out) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      out[3 * i + j] = first[3 * i + j] + then[3 * i + j] + then[3 * i] * first[j] +
                       then[3 * i + 1] * first[3 + j] + then[3 * i + 2] * first[6 + j];
}

/// The pose at tangent coordinates q: dx, what particles move by, and the links' new directions in
/// w.turn (pointer: the change of its direction in the first three). shift: [m] of a pinned root.
/// Lengths are exact: square roots, nothing is iterated. off: as of rotation.
template <class R>
RAGDOLL_INLINE void retract(const Tree& t, const R* q, const V3<R>& shift, Work<R>& w, R* dx,
                            R& off) {
  using N = typename NumberOf<R>::Type;
  for (const TreeRoot& root : t.roots)
    store3(root.pinned ? shift : load3(q + root.first), dx + 3 * root.particle);
  for (std::size_t j = 0; j < t.links.size(); ++j) {
    const TreeLink& k = t.links[j];
    const R* axes = w.axes + 9 * j;
    R* turn = w.turn + 9 * j;
    const V3<R> o = load3(dx + 3 * k.attach);
    if (k.kind == TreeLink::Kind::kPointer) {
      const R a = q[k.first], b = q[k.first + 1];
      const R s2 = a * a + b * b;
      off = larger(s2, off);
      const R less = -s2 / (N(1) + squareRoot(atLeast(N(1) - s2, N(0))));
      const V3<R> change = less * load3(axes) + a * load3(axes + 3) + b * load3(axes + 6);
      store3(change, turn);
      for (int i = k.points_begin; i < k.points_end; ++i)
        store3(o + N(t.points[i].at[0]) * change, dx + 3 * t.points[i].particle);
      continue;
    }
    if (k.kind == TreeLink::Kind::kTurn) {
      rotation(load3(q + k.first), turn, off);
    } else {
      R own[9];
      rotation(q[k.first] * load3(axes), own, off);
      compose(own, w.turn + 9 * k.parent, turn);
    }
    for (int i = k.points_begin; i < k.points_end; ++i)
      store3(o + multiply(turn, load3(w.lever + 3 * i)), dx + 3 * t.points[i].particle);
  }
}

/// sum of m r x (A r), from the second moments of m r r^T (xx yy zz xy xz yz).
template <class R>
RAGDOLL_INLINE V3<R> turned(const R* a, const R* s) {
  const V3<R> x{s[0], s[3], s[4]}, y{s[3], s[1], s[5]}, z{s[4], s[5], s[2]};
  const V3<R> ax = load3(a), ay = load3(a + 3), az = load3(a + 6);
  return {dot(y, az) - dot(z, ay), dot(z, ax) - dot(x, az), dot(x, ay) - dot(y, ax)};
}

/// out (size) = T^T M dx for the dx that `retract` found, from the links' moments: as `momentum`
/// and `gather`, without a sum over particles. One root.
template <class R>
RAGDOLL_INLINE void project(const Tree& t, Work<R>& w, const R* dx, R* out) {
  using N = typename NumberOf<R>::Type;
  for (std::size_t i = 0; i < 3 * t.links.size(); ++i) w.torque[i] = w.thrust[i] = R{};
  const TreeRoot& root = t.roots[0];
  V3<R> whole = N(root.mass) * load3(dx + 3 * root.particle);
  for (std::size_t j = t.links.size(); j-- > 0;) {
    const TreeLink& k = t.links[j];
    const R* axes = w.axes + 9 * j;
    const R* turn = w.turn + 9 * j;
    const V3<R> o = load3(dx + 3 * k.attach);
    // f: of it and of what hangs on it, less the mass at `attach`; l: moment about that.
    V3<R> f = load3(w.thrust + 3 * j), l = load3(w.torque + 3 * j);
    if (k.kind == TreeLink::Kind::kPointer) {
      const V3<R> change = load3(turn);
      f = f + N(k.moment[0]) * change;
      l = l + (N(k.moment[0]) * o + N(k.second[0]) * change);
      out[k.first] = dot(load3(axes + 3), l);
      out[k.first + 1] = dot(load3(axes + 6), l);
    } else {
      const R* own = w.own + 9 * j;
      const V3<R> m = load3(own);
      f = f + multiply(turn, m);
      l = l + (cross(m, o) + turned(turn, own + 3));
      if (k.kind == TreeLink::Kind::kTurn)
        store3(l, out + k.first);
      else
        out[k.first] = dot(load3(axes), l);
    }
    if (k.parent < 0) {
      whole = whole + f;
      continue;
    }
    R* thrust = w.thrust + 3 * k.parent;
    R* torque = w.torque + 3 * k.parent;
    if (k.kind == TreeLink::Kind::kFold) {
      const N mass = N(k.mass);
      l = l + onParent(t, w, k, f + mass * o);
      f = f + mass * (o - load3(dx + 3 * t.links[k.parent].attach));
    } else {
      l = onParent(t, w, k, f);
    }
    store3(load3(thrust) + f, thrust);
    store3(load3(torque) + l, torque);
  }
  if (!root.pinned) store3(whole, out + root.first);
}

/// x1 of the pose that `retract` found, every link laid anew from the root: no error adds up.
template <class R>
RAGDOLL_INLINE void place(const Tree& t, const Work<R>& w, const R* x, const R* dx, R* x1) {
  using N = typename NumberOf<R>::Type;
  for (const TreeRoot& root : t.roots)
    store3(load3(x + 3 * root.particle) + load3(dx + 3 * root.particle), x1 + 3 * root.particle);
  for (std::size_t j = 0; j < t.links.size(); ++j) {
    const TreeLink& k = t.links[j];
    const R* turn = w.turn + 9 * j;
    const V3<R> o = load3(x1 + 3 * k.attach);
    if (k.kind == TreeLink::Kind::kPointer) {
      const V3<R> u = load3(w.axes + 9 * j) + load3(turn);
      for (int i = k.points_begin; i < k.points_end; ++i)
        store3(o + N(t.points[i].at[0]) * u, x1 + 3 * t.points[i].particle);
      continue;
    }
    for (int i = k.points_begin; i < k.points_end; ++i) {
      const V3<R> r = load3(w.lever + 3 * i);
      store3(o + (r + multiply(turn, r)), x1 + 3 * t.points[i].particle);
    }
  }
}

}  // namespace ragdoll::tree
