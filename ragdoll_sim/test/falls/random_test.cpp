// The numbers that falls are drawn with: data sets stand and fall with their bits.
#include "falls/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ragdoll::falls {
namespace {

TEST(Random, HasTheSpecifiedBits) {
  // From another program, which gives SplitMix64's published numbers for its published seed.
  constexpr double kBit = 0x1p-53;
  Random zero(0, 0), seven(7, 0), other_kind(7, 0x5ce9e);
  EXPECT_EQ(zero.uniform(0, 1), 3044905813493120 * kBit);
  EXPECT_EQ(zero.uniform(0, 1), 2424109978418670 * kBit);
  EXPECT_EQ(seven.uniform(0, 1), 8558292891254773 * kBit);
  EXPECT_EQ(seven.uniform(0, 1), 7923515918811736 * kBit);
  EXPECT_EQ(other_kind.uniform(0, 1), 6683659100987739 * kBit);
  EXPECT_EQ(other_kind.uniform(0, 1), 2263438548335041 * kBit);
}

TEST(Random, FillsItsRange) {
  Random random(1, 0), same(1, 0);
  double sum = 0;
  constexpr int kCount = 10000;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.uniform(-3, 5);
    EXPECT_EQ(x, -3 + 8 * same.uniform(0, 1));
    sum += x;
  }
  EXPECT_NEAR(sum / kCount, 1, 4 * 8 / std::sqrt(12.0 * kCount));  // four deviations of the mean
}

TEST(Random, BellHasMeanZeroDeviationOneAndEndsAtSix) {
  Random random(2, 0);
  double sum = 0, squares = 0;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    EXPECT_LT(std::abs(x), 6);
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / kCount, 0, 4 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 1, 4 * std::sqrt(2.0 / kCount));
}

}  // namespace
}  // namespace ragdoll::falls
