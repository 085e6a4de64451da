// How fast a simulation is, by a clock that ticks often or seldom.
#include "ragdoll_sim/world/pace.h"

#include <gtest/gtest.h>

namespace {

using ragdoll::Pace;

TEST(Pace, isThatOfThePeriod) {
  Pace pace;
  EXPECT_DOUBLE_EQ(pace.after(0.5, 1, false), 0.5);
  EXPECT_DOUBLE_EQ(pace.after(0, 1, false), 0);
  EXPECT_DOUBLE_EQ(pace.after(2, 1.25, true), 1.6);
}

TEST(Pace, isOneOfAClockThatTicksSeldom) {
  Pace pace;
  double simulated = 0;
  for (int second = 1; second <= 60; ++second) {  // a tick each 2.5 s
    const double now = 2.5 * static_cast<int>(second / 2.5);
    const double told = pace.after(now - simulated, 1, true);
    simulated = now;
    if (second < 6) continue;
    EXPECT_GT(told, 0.8) << second;
    EXPECT_LT(told, 1.3) << second;
  }
}

TEST(Pace, isZeroOnceTheClockStands) {
  Pace pace;
  EXPECT_DOUBLE_EQ(pace.after(1, 1, true), 1);
  for (int second = 1; second < Pace::kLongest; ++second)
    EXPECT_DOUBLE_EQ(pace.after(0, 1, true), 1);
  EXPECT_DOUBLE_EQ(pace.after(0, 1, true), 0);
  EXPECT_DOUBLE_EQ(pace.after(0, 1, true), 0);
  EXPECT_DOUBLE_EQ(pace.after(1, 1, true), 0.5);
}

}  // namespace
