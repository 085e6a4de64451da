#include "core/contact/golden_section.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ragdoll {
namespace {

TEST(GoldenSection, FindsWhereAConvexFunctionIsLeast) {
  int calls = 0;
  const auto bowl = [&calls](double s) {
    ++calls;
    return std::abs(s - 0.3) + 0.1 * s;
  };
  EXPECT_NEAR(goldenSection(bowl, -1, 2), 0.3, 3e-7);
  EXPECT_EQ(calls, 2 + 32);
}

TEST(GoldenSection, GoesToTheEndThatIsLess) {
  EXPECT_NEAR(goldenSection([](double s) { return s; }, -1, 1), -1, 5e-7);
  EXPECT_NEAR(goldenSection([](double s) { return -s; }, -1, 1), 1, 5e-7);
}

}  // namespace
}  // namespace ragdoll
