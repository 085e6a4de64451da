// All operations of packs on the same numbers, for units of each instruction set: these give plain
// functions (pack_units.h), as what is inlined there must not come into another unit.
#pragma once

#include "core/fast/pack.h"
#include "core/fast/pack_units.h"

namespace ragdoll::test {
namespace {

template <class R, class N>
void operate(const R& a, const R& b, N number, R* out) {
  using namespace fast;
  out[kPlus] = a + b;
  out[kMinus] = a - b;
  out[kTimes] = a * b;
  out[kOver] = a / b;
  out[kPlusNumber] = a + number;
  out[kNumberMinus] = number - a;
  out[kNumberTimes] = number * a;
  out[kOverNumber] = a / number;
  out[kNegative] = -a;
  out[kAdded] = out[kTaken] = a;
  out[kAdded] += b;
  out[kTaken] -= b;
  out[kSelected] = select(less(a, b), a, b);
  out[kBoth] = select(both(less(a, b), less(R{}, b)), a, b);
  out[kEither] = select(either(less(a, b), less(R{}, b)), a, b);
  out[kRoot] = squareRoot(a);
  out[kLarger] = larger(a, b);
  out[kAtLeast] = atLeast(a, number);
  out[kSign] = signOf(a);
}

/// out: kOperations results of each of `count` pairs, by packs of W.
template <class N, int W>
void operateOn(const N* a, const N* b, int count, N* out) {
  using R = typename fast::RealOf<N, W>::Type;
  for (int i = 0; i < count; i += W) {
    R x{}, y{}, results[kOperations];
    for (int l = 0; l < W; ++l) {
      fast::setLane(x, l, a[i + l]);
      fast::setLane(y, l, b[i + l]);
    }
    operate(x, y, N(kNumber), results);
    for (int l = 0; l < W; ++l)
      for (int k = 0; k < kOperations; ++k)
        out[kOperations * (i + l) + k] = fast::lane(results[k], l);
  }
}

/// Which of the first W lanes are set, says `lanesOf`; 0 where `any` says that none is.
template <class N, int W>
unsigned lanesOf(const bool* lanes) {
  typename fast::RealOf<N, W>::Type x{}, zero{};
  for (int l = 0; l < W; ++l) fast::setLane(x, l, N(lanes[l] ? 1 : 0));
  const auto set = fast::less(zero, x);
  return fast::any(set) ? fast::lanesOf(set) : 0;
}

template <int W64, int W32>
constexpr PackUnit unitOf() {
  return {{W64, &operateOn<double, W64>, &lanesOf<double, W64>},
          {W32, &operateOn<float, W32>, &lanesOf<float, W32>}};
}

}  // namespace
}  // namespace ragdoll::test
