// How often positive values fell where, on a logarithmic scale: percentiles in fixed memory.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ragdoll {

/// 20 bins to the decade from 1e-6 to 1e3: a percentile is right to 6 %. Values outside count in the
/// first and the last bin.
class Histogram {
 public:
  void add(double value) {
    ++counts_[binOf(value)];
    ++count_;
    max_ = std::max(max_, value);
  }

  void add(const Histogram& other) {
    for (std::size_t i = 0; i < kBins; ++i) counts_[i] += other.counts_[i];
    count_ += other.count_;
    max_ = std::max(max_, other.max_);
  }

  std::uint64_t count() const { return count_; }
  double max() const { return max_; }  ///< exact; 0 before the first value

  /// The value that the given share of all values does not exceed, in [0, 1]; 0 before the first.
  double percentile(double share) const {
    const double wanted = share * static_cast<double>(count_);
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
      below += counts_[i];
      if (below > 0 && static_cast<double>(below) >= wanted) return std::min(middleOf(i), max_);
    }
    return max_;
  }

 private:
  static constexpr double kSmallest = 1e-6, kPerDecade = 20;
  static constexpr std::size_t kBins = 180;

  static std::size_t binOf(double value) {
    if (!(value > kSmallest)) return 0;
    const double bin = kPerDecade * std::log10(value / kSmallest);
    return bin < kBins ? static_cast<std::size_t>(bin) : kBins - 1;
  }
  static double middleOf(std::size_t bin) {
    return kSmallest * std::pow(10.0, (static_cast<double>(bin) + 0.5) / kPerDecade);
  }

  std::array<std::uint32_t, kBins> counts_{};
  std::uint64_t count_ = 0;
  double max_ = 0;
};

}  // namespace ragdoll
