#include "core/contact/first_touch.h"

#include <gtest/gtest.h>

namespace ragdoll {
namespace {

/// The gap of a point that goes straight past a ball: hypot(a (1 - t / t0), b) - r, at zero there.
TEST(FirstTouch, FindsWhereAPathMeetsABall) {
  const double reach = 0.3, beside = 0.18, first = 0.25, speed = 2;
  const double away = std::sqrt(reach * reach - beside * beside);  // of the middle, as it touches
  const auto gap = [&](double t) {
    return std::hypot(away - speed * (t - first), beside) - reach;
  };
  EXPECT_NEAR(firstTouch(gap, 0, gap(0), 0.4, gap(0.4)), first, 1e-12);
}

TEST(FirstTouch, FindsThePlaneAtOnce) {
  int asked = 0;
  const auto gap = [&](double t) {
    ++asked;
    return 1 - 4 * t;
  };
  EXPECT_DOUBLE_EQ(firstTouch(gap, 0, 1, 1, -3), 0.25);
  EXPECT_EQ(asked, 1);
}

/// Where the gap bends hard at its end, the end that stays loses half its weight each time.
TEST(FirstTouch, IsNotHeldUpByAFlatEnd) {
  int asked = 0;
  const auto gap = [&](double t) {
    ++asked;
    return std::pow(1 - t, 9) - 1e-3;
  };
  const double right = 1 - std::pow(1e-3, 1.0 / 9);
  EXPECT_NEAR(firstTouch(gap, 0, gap(0), 1, gap(1)), right, 1e-11);
  EXPECT_LT(asked, 25);
}

}  // namespace
}  // namespace ragdoll
