// What a tree's solver computes, for doubles and for packs of them alike: Real is a number or one
// for each of several bodies. No branch depends on values, so that a lane's bits do not depend on
// its neighbours. docs/fast.md#tree. Private to the core; no Eigen (tree.h).
//
// A wrench (l, f) is what acts on a link: f, a force anywhere on what hangs on it, and l, its
// moment about the link's `attach`; of a pointer l is the force times its reach.
#pragma once

#include <cmath>

#include "core/linear/lanes.h"
#include "core/linear/tree.h"

namespace ragdoll::tree {

RAGDOLL_INLINE double squareRoot(double a) { return std::sqrt(a); }
RAGDOLL_INLINE float squareRoot(float a) { return std::sqrt(a); }
RAGDOLL_INLINE double atLeast(double a, double least) { return a < least ? least : a; }
RAGDOLL_INLINE float atLeast(float a, float least) { return a < least ? least : a; }
/// 1 with the sign of a.
RAGDOLL_INLINE double signOf(double a) { return a < 0 ? -1.0 : 1.0; }
RAGDOLL_INLINE float signOf(float a) { return a < 0 ? -1.0f : 1.0f; }
RAGDOLL_INLINE double larger(double a, double b) { return a > b ? a : b; }
RAGDOLL_INLINE float larger(float a, float b) { return a > b ? a : b; }

/// A number as Real has them: constants of the model are doubles.
template <class Real>
struct NumberOf {
  using Type = Real;
};

template <class Real>
struct V3 {
  Real x, y, z;
};

template <class R>
RAGDOLL_INLINE V3<R> operator+(const V3<R>& a, const V3<R>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class R>
RAGDOLL_INLINE V3<R> operator-(const V3<R>& a, const V3<R>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class R, class S>
RAGDOLL_INLINE V3<R> operator*(const S& s, const V3<R>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class R>
RAGDOLL_INLINE R dot(const V3<R>& a, const V3<R>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class R>
RAGDOLL_INLINE V3<R> cross(const V3<R>& a, const V3<R>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class R>
RAGDOLL_INLINE V3<R> load3(const R* p) {
  return {p[0], p[1], p[2]};
}
template <class R>
RAGDOLL_INLINE void store3(const V3<R>& a, R* p) {
  p[0] = a.x;
  p[1] = a.y;
  p[2] = a.z;
}
template <class R>
RAGDOLL_INLINE R zero() {
  return R{};
}

constexpr double kShortest = 1e-18;  ///< [m^2] shorter, a link has no direction; guards a division

template <class R>
RAGDOLL_INLINE V3<R> unit(const V3<R>& a) {
  using N = typename NumberOf<R>::Type;
  return (N(1) / squareRoot(atLeast(dot(a, a), N(kShortest)))) * a;
}

/// A body's tree at one pose, and room for what is worked out there. The owner gives the memory.
template <class R>
struct Work {
  R* axes;     ///< 9 per link: pointer: direction and two square to it; else frame, axis by axis
  R* lever;    ///< [m] 3 per point, from attach; pointers': none
  R* moment;   ///< [kg m] 3 per link, world; folds on it included; pointers': none
  R* second;   ///< [kg m^2] 6 per link, likewise
  R* own;      ///< 9 per link: moment and second without what folds on it
  R* H;        ///< per coordinate and ancestor; factorised in place
  R* inverse;  ///< per coordinate: H's diagonal; factorised: 1 / pivot
  R* turn;     ///< 9 per link: rotation less identity, row by row; pointers': none
  R* force;    ///< [N] 3 per particle: scratch
  R* torque;   ///< 3 per link: scratch
  R* thrust;   ///< likewise

  /// How many numbers `memory` has to hold.
  static int count(const Tree& t) {
    const int links = static_cast<int>(t.links.size());
    return links * 42 + 3 * static_cast<int>(t.points.size()) + static_cast<int>(t.chain.size()) +
           t.size + 3 * t.particles + 1;
  }
  void take(const Tree& t, R* memory) {
    const int links = static_cast<int>(t.links.size());
    R** parts[] = {&axes,    &lever, &moment, &second, &own,   &H,
                   &inverse, &turn,  &force,  &torque, &thrust};
    const int counts[] = {9 * links,       3 * static_cast<int>(t.points.size()),
                          3 * links,       6 * links,
                          9 * links,       static_cast<int>(t.chain.size()),
                          t.size,          9 * links,
                          3 * t.particles, 3 * links,
                          3 * links};
    for (int i = 0; i < 11; ++i) {
      *parts[i] = memory;
      memory += counts[i];
    }
  }
};

/// Two directions square to the unit vector u, without a branch [Duff2017].
template <class R>
RAGDOLL_INLINE void basis(const V3<R>& u, V3<R>& e1, V3<R>& e2) {
  using N = typename NumberOf<R>::Type;
  const R sign = signOf(u.z);
  const R a = N(-1) / (sign + u.z), b = u.x * u.y * a;
  e1 = {N(1) + sign * u.x * u.x * a, sign * b, -sign * u.x};
  e2 = {b, sign + u.y * u.y * a, -u.y};
}

/// The links' directions at positions x (3 per particle).
template <class R>
RAGDOLL_INLINE void setFrames(const Tree& t, const R* x, Work<R>& w) {
  using N = typename NumberOf<R>::Type;
  for (std::size_t j = 0; j < t.links.size(); ++j) {
    const TreeLink& link = t.links[j];
    const V3<R> o = load3(x + 3 * link.attach);
    const V3<R> u = unit(load3(x + 3 * link.base[0]) - o);
    V3<R> e1, e2;
    if (link.kind == TreeLink::Kind::kPointer) {
      basis(u, e1, e2);
    } else {
      e2 = unit(cross(u, load3(x + 3 * link.base[1]) - o));
      e1 = cross(e2, u);
      for (int i = link.points_begin; i < link.points_end; ++i) {
        const double* c = t.points[i].at;
        store3(N(c[0]) * u + N(c[1]) * e1 + N(c[2]) * e2, w.lever + 3 * i);
      }
    }
    store3(u, w.axes + 9 * j);
    store3(e1, w.axes + 9 * j + 3);
    store3(e2, w.axes + 9 * j + 6);
  }
}

/// What acts on the link's `attach` as it acts on the parent.
template <class R>
RAGDOLL_INLINE V3<R> onParent(const Tree& t, const Work<R>& w, const TreeLink& link,
                              const V3<R>& f) {
  using N = typename NumberOf<R>::Type;
  if (link.at < 0) return V3<R>{};
  if (t.links[link.parent].kind == TreeLink::Kind::kPointer) return N(t.points[link.at].at[0]) * f;
  return cross(load3(w.lever + 3 * link.at), f);
}

/// out[c][stride * place[k]] = force along coordinate k, for wrenches (l[c], f[c]) on `link` and
/// all coordinates above.
template <int count, int stride, class R>
RAGDOLL_INLINE void spread(const Tree& t, const Work<R>& w, int link, V3<R>* l, const V3<R>* f,
                           int root, const int* place, R* const* out) {
  while (link >= 0) {
    const TreeLink& k = t.links[link];
    const R* axes = w.axes + 9 * link;
    const int at = stride * place[k.first];  // the coordinates of a link follow each other
    const bool folds = k.kind == TreeLink::Kind::kFold;
    if (k.kind == TreeLink::Kind::kPointer) {
      const V3<R> e1 = load3(axes + 3), e2 = load3(axes + 6);
      for (int c = 0; c < count; ++c) {
        out[c][at] = dot(e1, l[c]);
        out[c][at + stride] = dot(e2, l[c]);
      }
    } else if (folds) {
      const V3<R> e = load3(axes);
      for (int c = 0; c < count; ++c) out[c][at] = dot(e, l[c]);
    } else {
      for (int c = 0; c < count; ++c) {
        out[c][at] = l[c].x;
        out[c][at + stride] = l[c].y;
        out[c][at + 2 * stride] = l[c].z;
      }
    }
    link = k.parent;
    if (link < 0) break;
    for (int c = 0; c < count; ++c) {
      const V3<R> above = onParent(t, w, k, f[c]);
      l[c] = folds ? l[c] + above : above;
    }
  }
  if (t.roots[root].pinned) return;
  const int at = stride * place[t.roots[root].first];
  for (int c = 0; c < count; ++c) {
    out[c][at] = f[c].x;
    out[c][at + stride] = f[c].y;
    out[c][at + 2 * stride] = f[c].z;
  }
}

}  // namespace ragdoll::tree
