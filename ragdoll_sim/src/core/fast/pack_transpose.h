// From numbers of one body to packs of bodies and back: transposes, and doubles that follow each
// other. Private to units that are compiled for an instruction set.
#pragma once

#include <cstring>
#include <utility>

#include "core/fast/pack.h"

namespace ragdoll::fast {

template <int s, class V, std::size_t... I>
RAGDOLL_INLINE void swapBlocks(V& a, V& b, std::index_sequence<I...>) {
  constexpr int W = sizeof...(I);
  const V lo = a, hi = b;
#if defined(__clang__)
  a = __builtin_shufflevector(lo, hi, (I & s ? W + I - s : I)...);
  b = __builtin_shufflevector(lo, hi, (I & s ? W + I : I + s)...);
#else
  typedef decltype(lo < hi) Index;
  a = __builtin_shuffle(lo, hi, Index{(I & s ? W + I - s : I)...});
  b = __builtin_shuffle(lo, hi, Index{(I & s ? W + I : I + s)...});
#endif
}

/// a[i], lane k <-> a[k], lane i.
template <int s = 1, class T, int W>
RAGDOLL_INLINE void transpose(Pack<T, W>* a) {
  if constexpr (s < W) {
    for (int i = 0; i < W; ++i)
      if (!(i & s)) swapBlocks<s>(a[i].v, a[i + s].v, std::make_index_sequence<W>());
    transpose<2 * s>(a);
  }
}

/// W doubles that follow each other.
template <int W>
struct Doubles {
  typedef double Vector __attribute__((vector_size(W * sizeof(double))));
  Vector v;

  static RAGDOLL_INLINE Doubles at(const double* from) {
    Doubles out;
    std::memcpy(&out.v, from, sizeof(out.v));
    return out;
  }
  RAGDOLL_INLINE void to(double* there) const { std::memcpy(there, &v, sizeof(v)); }
};
template <class T, int W>
RAGDOLL_INLINE Pack<T, W> numbersOf(const Doubles<W>& a) {
  return {__builtin_convertvector(a.v, typename Pack<T, W>::Vector)};
}
template <class T, int W>
RAGDOLL_INLINE Doubles<W> doublesOf(const Pack<T, W>& a) {
  return {__builtin_convertvector(a.v, typename Doubles<W>::Vector)};
}

}  // namespace ragdoll::fast
