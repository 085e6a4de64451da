// The matrix H of a tree and its factors (tree_kernels.h). docs/fast.md#tree.
#pragma once

#include "core/linear/tree_kernels.h"

namespace ragdoll::tree {

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

}  // namespace ragdoll::tree
