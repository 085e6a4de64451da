#include "ragdoll_sim/core/number_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ragdoll {
namespace {

TEST(NumberText, IsShortAndKnowsNoNegativeNan) {
  EXPECT_EQ(numberText(0.25), "0.25");
  EXPECT_EQ(numberText(-1e-9), "-1e-09");
  EXPECT_EQ(numberText(1234567.0), "1.23457e+06");
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(numberText(-infinity), "-inf");
  EXPECT_EQ(numberText(std::copysign(std::nan(""), -1)), "nan");
}

}  // namespace
}  // namespace ragdoll
