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

/// Symmetric (xx yy zz xy xz yz) times vector.
template <class R>
RAGDOLL_INLINE V3<R> times(const R* s, const V3<R>& v) {
  return {s[0] * v.x + s[3] * v.y + s[4] * v.z, s[3] * v.x + s[1] * v.y + s[5] * v.z,
          s[4] * v.x + s[5] * v.y + s[2] * v.z};
}

/// World moments of the links that turn, with what folds on them. [Featherstone2008, sec. 6.2]
template <class R>
RAGDOLL_INLINE void setMoments(const Tree& t, Work<R>& w) {
  using N = typename NumberOf<R>::Type;
  for (std::size_t j = 0; j < t.links.size(); ++j) {
    const TreeLink& k = t.links[j];
    if (k.kind == TreeLink::Kind::kPointer) continue;
    const V3<R> q[3] = {load3(w.axes + 9 * j), load3(w.axes + 9 * j + 3),
                        load3(w.axes + 9 * j + 6)};
    store3(N(k.moment[0]) * q[0] + N(k.moment[1]) * q[1] + N(k.moment[2]) * q[2], w.moment + 3 * j);
    const double* s = k.second;
    const V3<R> p[3] = {N(s[0]) * q[0] + N(s[3]) * q[1] + N(s[4]) * q[2],
                        N(s[3]) * q[0] + N(s[1]) * q[1] + N(s[5]) * q[2],
                        N(s[4]) * q[0] + N(s[5]) * q[1] + N(s[2]) * q[2]};
    R* out = w.second + 6 * j;
    out[0] = q[0].x * p[0].x + q[1].x * p[1].x + q[2].x * p[2].x;
    out[1] = q[0].y * p[0].y + q[1].y * p[1].y + q[2].y * p[2].y;
    out[2] = q[0].z * p[0].z + q[1].z * p[1].z + q[2].z * p[2].z;
    out[3] = q[0].x * p[0].y + q[1].x * p[1].y + q[2].x * p[2].y;
    out[4] = q[0].x * p[0].z + q[1].x * p[1].z + q[2].x * p[2].z;
    out[5] = q[0].y * p[0].z + q[1].y * p[1].z + q[2].y * p[2].z;
    R* own = w.own + 9 * j;
    store3(load3(w.moment + 3 * j), own);
    for (int i = 0; i < 6; ++i) own[3 + i] = out[i];
  }
  for (std::size_t j = t.links.size(); j-- > 0;) {
    const TreeLink& k = t.links[j];
    if (k.kind != TreeLink::Kind::kFold) continue;
    const V3<R> m = load3(w.moment + 3 * j);
    const V3<R> d = k.at < 0 ? V3<R>{} : load3(w.lever + 3 * k.at);
    const R* s = w.second + 6 * j;
    R* up = w.second + 6 * k.parent;
    const V3<R> e = m + N(k.mass) * d;
    up[0] += s[0] + (m.x + e.x) * d.x;
    up[1] += s[1] + (m.y + e.y) * d.y;
    up[2] += s[2] + (m.z + e.z) * d.z;
    up[3] += s[3] + m.x * d.y + d.x * e.y;
    up[4] += s[4] + m.x * d.z + d.x * e.z;
    up[5] += s[5] + m.y * d.z + d.y * e.z;
    store3(load3(w.moment + 3 * k.parent) + e, w.moment + 3 * k.parent);
  }
}

/// H = T^T M T [kg m^2, kg m, kg]. depth: of each coordinate, its number of ancestors.
template <class R>
RAGDOLL_INLINE void setMatrix(const Tree& t, const int* depth, Work<R>& w) {
  using N = typename NumberOf<R>::Type;
  setMoments(t, w);
  const int* begin = t.chain_begin.data();
  for (const TreeRoot& root : t.roots)
    for (int c = 0; c < (root.pinned ? 0 : 3); ++c) {
      w.inverse[root.first + c] = R{} + N(root.mass);
      for (int i = begin[root.first + c]; i < begin[root.first + c + 1]; ++i) w.H[i] = R{};
    }
  for (std::size_t j = 0; j < t.links.size(); ++j) {
    const TreeLink& k = t.links[j];
    const R* axes = w.axes + 9 * j;
    if (k.kind == TreeLink::Kind::kPointer) {
      const V3<R> f[2] = {N(k.moment[0]) * load3(axes + 3), N(k.moment[0]) * load3(axes + 6)};
      V3<R> l[2] = {onParent(t, w, k, f[0]), onParent(t, w, k, f[1])};
      R* const row[2] = {w.H + begin[k.first], w.H + begin[k.first + 1]};
      w.inverse[k.first] = w.inverse[k.first + 1] = R{} + N(k.second[0]);
      row[1][depth[k.first]] = R{};
      spread<2, 1>(t, w, k.parent, l, f, k.root, depth, row);
      continue;
    }
    const R* s = w.second + 6 * j;
    const R trace = s[0] + s[1] + s[2];
    const V3<R> m = load3(w.moment + 3 * j);
    if (k.kind == TreeLink::Kind::kFold) {
      const V3<R> a = load3(axes), f = cross(a, m), l = trace * a - times(s, a);
      w.inverse[k.first] = dot(a, l);
      V3<R> above = l + onParent(t, w, k, f);
      R* const row = w.H + begin[k.first];
      spread<1, 1>(t, w, k.parent, &above, &f, k.root, depth, &row);
      continue;
    }
    const V3<R> f[3] = {{R{}, -m.z, m.y}, {m.z, R{}, -m.x}, {-m.y, m.x, R{}}};
    V3<R> l[3];
    R* row[3];
    for (int c = 0; c < 3; ++c) {
      row[c] = w.H + begin[k.first + c];
      w.inverse[k.first + c] = trace - s[c];
      l[c] = onParent(t, w, k, f[c]);
    }
    row[1][depth[k.first]] = -s[3];
    row[2][depth[k.first]] = -s[4];
    row[2][depth[k.first] + 1] = -s[5];
    spread<3, 1>(t, w, k.parent, l, f, k.root, depth, row);
  }
}

/// Whether coordinates k - 1 and k are a pointer's: they have the same ancestors.
RAGDOLL_INLINE bool isSecond(const int* begin, const int* chain, int k) {
  return k > 0 && begin[k + 1] - begin[k] > 0 && chain[begin[k + 1] - 1] == k - 1;
}

/// H = L^T L in place, from the leaves to the root [Featherstone2008, table 6.3]: L's rows, and the
/// inverse of its diagonal. A coordinate and its next ancestor, where that has the number before,
/// are eliminated at once: half as many stores.
template <class R>
RAGDOLL_INLINE void factorise(const Tree& t, double floor, Work<R>& w) {
  using N = typename NumberOf<R>::Type;
  const int* begin = t.chain_begin.data();
  const int* all = t.chain.data();
  for (int k = t.size - 1; k >= 0; --k) {
    R* row = w.H + begin[k];
    const int depth = begin[k + 1] - begin[k];
    const R inverse = N(1) / squareRoot(atLeast(w.inverse[k], N(floor)));
    w.inverse[k] = inverse;
    for (int i = 0; i < depth; ++i) row[i] = row[i] * inverse;
    if (!isSecond(begin, all, k)) {
      for (int i = 0; i < depth; ++i) {
        const R factor = row[i];
        R* up = w.H + begin[all[begin[k] + i]];
        for (int j = 0; j < i; ++j) up[j] -= factor * row[j];
        w.inverse[all[begin[k] + i]] -= factor * factor;
      }
      continue;
    }
    --k;
    const int above = depth - 1;
    R* next = w.H + begin[k];
    const R shared = row[above];
    const R inverse2 = N(1) / squareRoot(atLeast(w.inverse[k] - shared * shared, N(floor)));
    w.inverse[k] = inverse2;
    for (int i = 0; i < above; ++i) next[i] = (next[i] - shared * row[i]) * inverse2;
    for (int i = 0; i < above; ++i) {
      const R a = row[i], b = next[i];
      R* up = w.H + begin[all[begin[k] + i]];
      for (int j = 0; j < i; ++j) up[j] -= a * row[j] + b * next[j];
      w.inverse[all[begin[k] + i]] -= a * a + b * b;
    }
  }
}

/// y <- L^-T y, of all coordinates.
template <class R>
RAGDOLL_INLINE void solveUp(const Tree& t, const Work<R>& w, R* y) {
  const int* begin = t.chain_begin.data();
  const int* all = t.chain.data();
  for (int k = t.size - 1; k >= 0; --k) {
    const R* row = w.H + begin[k];
    const int depth = begin[k + 1] - begin[k];
    const R value = y[k] * w.inverse[k];
    y[k] = value;
    if (!isSecond(begin, all, k)) {
      for (int i = 0; i < depth; ++i) y[all[begin[k] + i]] -= row[i] * value;
      continue;
    }
    --k;
    const R* next = w.H + begin[k];
    const R value2 = (y[k] - row[depth - 1] * value) * w.inverse[k];
    y[k] = value2;
    for (int i = 0; i < depth - 1; ++i) y[all[begin[k] + i]] -= row[i] * value + next[i] * value2;
  }
}

/// y <- L^-1 y, of all coordinates.
template <class R>
RAGDOLL_INLINE void solveDown(const Tree& t, const Work<R>& w, R* y) {
  const int* begin = t.chain_begin.data();
  const int* all = t.chain.data();
  for (int k = 0; k < t.size; ++k) {
    const int* chain = all + begin[k];
    const R* row = w.H + begin[k];
    const int depth = begin[k + 1] - begin[k];
    R sum = y[k];
    if (k + 1 == t.size || !isSecond(begin, all, k + 1)) {
      for (int i = 0; i < depth; ++i) sum -= row[i] * y[chain[i]];
      y[k] = sum * w.inverse[k];
      continue;
    }
    const R* next = w.H + begin[k + 1];
    R sum2 = y[k + 1];
    for (int i = 0; i < depth; ++i) {
      const R above = y[chain[i]];
      sum -= row[i] * above;
      sum2 -= next[i] * above;
    }
    const R value = sum * w.inverse[k];
    y[k] = value;
    ++k;
    y[k] = (sum2 - next[depth] * value) * w.inverse[k];
  }
}

/// out = L q.
template <class R>
RAGDOLL_INLINE void factorTimes(const Tree& t, const Work<R>& w, const R* q, R* out) {
  for (int k = 0; k < t.size; ++k) {
    out[k] = q[k] / w.inverse[k];
    for (int i = t.chain_begin[k]; i < t.chain_begin[k + 1]; ++i) out[k] += w.H[i] * q[t.chain[i]];
  }
}

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
