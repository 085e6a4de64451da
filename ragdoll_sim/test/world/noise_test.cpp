#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "ragdoll_sim/world/imu.h"

namespace ragdoll {
namespace {

/// Mean, deviation, third and fourth moment of the normal distribution, within five of their own
/// deviations for so many numbers.
TEST(NormalNumbers, HaveTheNormalMoments) {
  constexpr int kCount = 200000;
  std::vector<double> n(kCount);
  for (int i = 0; i < kCount; i += 4) normalNumbers(7, static_cast<std::uint64_t>(i), 4, &n[i]);
  double moment[5] = {};
  for (const double x : n)
    for (int k = 1; k <= 4; ++k) moment[k] += std::pow(x, k) / kCount;
  const double unit = 5 / std::sqrt(static_cast<double>(kCount));
  EXPECT_NEAR(moment[1], 0, unit);
  EXPECT_NEAR(moment[2], 1, unit * std::sqrt(2.0));
  EXPECT_NEAR(moment[3], 0, unit * std::sqrt(15.0));
  EXPECT_NEAR(moment[4], 3, unit * std::sqrt(96.0));
}

TEST(NormalNumbers, BelongToTheirStreamAndNumber) {
  double a[3], again[3], other[3], next[3];
  normalNumbers(1, 5, 3, a);
  normalNumbers(1, 5, 3, again);
  normalNumbers(2, 5, 3, other);
  normalNumbers(1, 6, 3, next);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(a[i], again[i]);
    EXPECT_NE(a[i], other[i]);
    EXPECT_NE(a[i], next[i]);
  }
}

}  // namespace
}  // namespace ragdoll
