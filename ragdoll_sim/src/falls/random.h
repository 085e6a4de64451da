// Random numbers with specified bits: SplitMix64 [Steele2014], and a bell from sums of it.
#pragma once

#include <cstdint>

namespace ragdoll::falls {

class Random {
 public:
  /// Streams of other numbers or kinds have nothing in common.
  Random(std::uint64_t number, std::uint64_t kind)
      : state_(mixed(mixed(number + 0x9e3779b97f4a7c15u) ^ (kind * 0xda942042e4dd58b5u))) {}

  double uniform(double from, double to) {
    state_ += 0x9e3779b97f4a7c15u;
    return from + (to - from) * (static_cast<double>(mixed(state_) >> 11) * 0x1p-53);
  }

  /// Mean 0, deviation 1, within 6: the sum of twelve.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform(0, 1);
    return sum;
  }

 private:
  static std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

}  // namespace ragdoll::falls
