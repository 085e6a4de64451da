// W numbers, one of each body: what the fast method computes with. The same operations on a single
// number have the same names, so that code for a pack is code for a number. gcc's vector
// extensions; private to units that are compiled for an instruction set. No Eigen.
#pragma once

#include <cmath>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "core/linear/tree_kernels.h"

namespace ragdoll::fast {

template <class T, int W>
struct Pack {
  typedef T Vector __attribute__((vector_size(W * sizeof(T))));
  Vector v;
};

template <class T, int W>
struct PackMask {
  decltype(typename Pack<T, W>::Vector{} < typename Pack<T, W>::Vector{}) m;
};

#define RAGDOLL_PACK_OPERATOR(op)                                                   \
  template <class T, int W>                                                         \
  RAGDOLL_INLINE Pack<T, W> operator op(const Pack<T, W>& a, const Pack<T, W>& b) { \
    return {a.v op b.v};                                                            \
  }                                                                                 \
  template <class T, int W>                                                         \
  RAGDOLL_INLINE Pack<T, W> operator op(const Pack<T, W>& a, T b) {                 \
    return {a.v op b};                                                              \
  }                                                                                 \
  template <class T, int W>                                                         \
  RAGDOLL_INLINE Pack<T, W> operator op(T a, const Pack<T, W>& b) {                 \
    return {a op b.v};                                                              \
  }
RAGDOLL_PACK_OPERATOR(+)
RAGDOLL_PACK_OPERATOR(-)
RAGDOLL_PACK_OPERATOR(*)
RAGDOLL_PACK_OPERATOR(/)
#undef RAGDOLL_PACK_OPERATOR

template <class T, int W>
RAGDOLL_INLINE Pack<T, W> operator-(const Pack<T, W>& a) {
  return {-a.v};
}
template <class T, int W>
RAGDOLL_INLINE void operator+=(Pack<T, W>& a, const Pack<T, W>& b) {
  a.v += b.v;
}
template <class T, int W>
RAGDOLL_INLINE void operator-=(Pack<T, W>& a, const Pack<T, W>& b) {
  a.v -= b.v;
}

template <class T, int W>
RAGDOLL_INLINE PackMask<T, W> less(const Pack<T, W>& a, const Pack<T, W>& b) {
  return {a.v < b.v};
}
RAGDOLL_INLINE bool less(double a, double b) { return a < b; }
RAGDOLL_INLINE bool less(float a, float b) { return a < b; }

template <class T, int W>
RAGDOLL_INLINE Pack<T, W> select(const PackMask<T, W>& m, const Pack<T, W>& a,
                                 const Pack<T, W>& b) {
  return {m.m ? a.v : b.v};
}
RAGDOLL_INLINE double select(bool m, double a, double b) { return m ? a : b; }
RAGDOLL_INLINE float select(bool m, float a, float b) { return m ? a : b; }

template <class T, int W>
RAGDOLL_INLINE PackMask<T, W> both(const PackMask<T, W>& a, const PackMask<T, W>& b) {
  return {a.m & b.m};
}
RAGDOLL_INLINE bool both(bool a, bool b) { return a && b; }
template <class T, int W>
RAGDOLL_INLINE PackMask<T, W> either(const PackMask<T, W>& a, const PackMask<T, W>& b) {
  return {a.m | b.m};
}
RAGDOLL_INLINE bool either(bool a, bool b) { return a || b; }

/// Whether it holds in any lane.
template <class T, int W>
RAGDOLL_INLINE bool any(const PackMask<T, W>& m) {
#if defined(__AVX512F__)
  if constexpr (sizeof(m) == 64) return _mm512_test_epi64_mask((__m512i)m.m, (__m512i)m.m) != 0;
#endif
#if defined(__AVX__)
  if constexpr (sizeof(m) == 32) return !_mm256_testz_si256((__m256i)m.m, (__m256i)m.m);
#endif
#if defined(__SSE2__)
  if constexpr (sizeof(m) == 16) return _mm_movemask_epi8((__m128i)m.m) != 0;
#endif
  for (int i = 0; i < W; ++i)
    if (m.m[i]) return true;
  return false;
}
RAGDOLL_INLINE bool any(bool m) { return m; }

/// The lanes where it holds, a bit each.
template <class T, int W>
RAGDOLL_INLINE unsigned lanesOf(const PackMask<T, W>& m) {
#if defined(__AVX512DQ__)
  if constexpr (sizeof(m) == 64 && sizeof(T) == 8) return _mm512_movepi64_mask((__m512i)m.m);
  if constexpr (sizeof(m) == 64 && sizeof(T) == 4) return _mm512_movepi32_mask((__m512i)m.m);
#endif
#if defined(__AVX__)
  if constexpr (sizeof(m) == 32 && sizeof(T) == 8) return _mm256_movemask_pd((__m256d)m.m);
  if constexpr (sizeof(m) == 32 && sizeof(T) == 4) return _mm256_movemask_ps((__m256)m.m);
#endif
#if defined(__SSE2__)
  if constexpr (sizeof(m) == 16 && sizeof(T) == 8) return _mm_movemask_pd((__m128d)m.m);
  if constexpr (sizeof(m) == 16 && sizeof(T) == 4) return _mm_movemask_ps((__m128)m.m);
#endif
  unsigned bits = 0;
  for (int i = 0; i < W; ++i) bits |= (m.m[i] ? 1u : 0u) << i;
  return bits;
}
RAGDOLL_INLINE unsigned lanesOf(bool m) { return m ? 1 : 0; }

template <class T, int W>
RAGDOLL_INLINE Pack<T, W> squareRoot(const Pack<T, W>& a) {
  typedef typename Pack<T, W>::Vector V;
#if defined(__AVX512F__)
  if constexpr (sizeof(V) == 64 && sizeof(T) == 8) return {(V)_mm512_sqrt_pd((__m512d)a.v)};
  if constexpr (sizeof(V) == 64 && sizeof(T) == 4) return {(V)_mm512_sqrt_ps((__m512)a.v)};
#endif
#if defined(__AVX__)
  if constexpr (sizeof(V) == 32 && sizeof(T) == 8) return {(V)_mm256_sqrt_pd((__m256d)a.v)};
  if constexpr (sizeof(V) == 32 && sizeof(T) == 4) return {(V)_mm256_sqrt_ps((__m256)a.v)};
#endif
#if defined(__SSE2__)
  if constexpr (sizeof(V) == 16 && sizeof(T) == 8) return {(V)_mm_sqrt_pd((__m128d)a.v)};
  if constexpr (sizeof(V) == 16 && sizeof(T) == 4) return {(V)_mm_sqrt_ps((__m128)a.v)};
#endif
  Pack<T, W> out = a;
  for (int i = 0; i < W; ++i) out.v[i] = std::sqrt(a.v[i]);
  return out;
}
using tree::squareRoot;

template <class T, int W>
RAGDOLL_INLINE Pack<T, W> larger(const Pack<T, W>& a, const Pack<T, W>& b) {
  return {a.v > b.v ? a.v : b.v};
}
template <class T, int W>
RAGDOLL_INLINE Pack<T, W> atLeast(const Pack<T, W>& a, T least) {
  const typename Pack<T, W>::Vector b = typename Pack<T, W>::Vector{} + least;
  return {a.v < b ? b : a.v};
}
template <class T, int W>
RAGDOLL_INLINE Pack<T, W> signOf(const Pack<T, W>& a) {
  const typename Pack<T, W>::Vector one = typename Pack<T, W>::Vector{} + T(1);
  return {a.v < 0 ? -one : one};
}
using tree::atLeast;
using tree::larger;
using tree::signOf;

template <class T, int W>
RAGDOLL_INLINE T lane(const Pack<T, W>& a, int i) {
  return a.v[i];
}
template <class T, int W>
RAGDOLL_INLINE void setLane(Pack<T, W>& a, int i, T value) {
  a.v[i] = value;
}
RAGDOLL_INLINE double lane(double a, int) { return a; }
RAGDOLL_INLINE float lane(float a, int) { return a; }
RAGDOLL_INLINE void setLane(double& a, int, double value) { a = value; }
RAGDOLL_INLINE void setLane(float& a, int, float value) { a = value; }

/// What W lanes of T are: T itself for one.
template <class T, int W>
struct RealOf {
  using Type = Pack<T, W>;
};
template <class T>
struct RealOf<T, 1> {
  using Type = T;
};

}  // namespace ragdoll::fast

namespace ragdoll::tree {
template <class T, int W>
struct NumberOf<fast::Pack<T, W>> {
  using Type = T;
};
}  // namespace ragdoll::tree
