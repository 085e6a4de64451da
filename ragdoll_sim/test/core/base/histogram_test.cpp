// Percentiles of values whose distribution is known.
#include "ragdoll_sim/core/histogram.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ragdoll {
namespace {

constexpr double kWidth = 0.062;  ///< relative; half a bin of a twentieth of a decade, rounded up

TEST(Histogram, percentilesOfAUniformDistribution) {
  Histogram h;
  for (int i = 1; i <= 100000; ++i) h.add(i * 1e-7);  // 0 to 10 ms
  EXPECT_EQ(h.count(), 100000u);
  for (const double share : {0.1, 0.5, 0.9, 0.99, 0.999})
    EXPECT_NEAR(h.percentile(share), share * 0.01, kWidth * share * 0.01) << share;
  EXPECT_EQ(h.percentile(1), h.max());
  EXPECT_EQ(h.max(), 0.01);
}

TEST(Histogram, oneInAThousandIsNotInThe999th) {
  Histogram h;
  for (int i = 0; i < 9990; ++i) h.add(1e-4);
  for (int i = 0; i < 10; ++i) h.add(2.0);
  EXPECT_NEAR(h.percentile(0.999), 1e-4, kWidth * 1e-4);
  EXPECT_NEAR(h.percentile(0.9995), 2, kWidth * 2);
}

TEST(Histogram, sumOfTwoIsThatOfAllValues) {
  Histogram a, b, all;
  for (int i = 0; i < 1000; ++i) {
    (i % 3 ? a : b).add(std::exp(-0.01 * i));
    all.add(std::exp(-0.01 * i));
  }
  a.add(b);
  EXPECT_EQ(a.count(), all.count());
  EXPECT_EQ(a.percentile(0.3), all.percentile(0.3));
  EXPECT_EQ(a.max(), all.max());
}

TEST(Histogram, whatIsOutsideCountsAtTheEnds) {
  Histogram h;
  EXPECT_EQ(h.percentile(0.5), 0);
  for (const double value : {-1.0, 0.0, 1e-9, std::nan("")}) h.add(value);
  EXPECT_LT(h.percentile(0.9), 2e-6);
  h.add(1e9);
  EXPECT_EQ(h.max(), 1e9);
  EXPECT_GT(h.percentile(1), 900);
}

}  // namespace
}  // namespace ragdoll
