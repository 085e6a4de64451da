#include "pareto.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace ragdoll::lab {
namespace {

using ::testing::ElementsAre;

TEST(Pareto, KeepsWhatNothingElseBeats) {
  // Cheap and wrong, dear and right, between them; beaten in both, in cost alone, in error alone.
  EXPECT_THAT(paretoFront({{1, 9}, {9, 1}, {3, 3}, {4, 4}, {5, 3}, {3, 5}}),
              ElementsAre(true, true, true, false, false, false));
}

TEST(Pareto, TwinsStayTogether) {
  EXPECT_THAT(paretoFront({{2, 2}, {2, 2}, {2, 3}}), ElementsAre(true, true, false));
}

TEST(Pareto, WhatDivergedIsNeverBestAndBeatsNothing) {
  EXPECT_THAT(paretoFront({{1, INFINITY}, {2, 1}, {1, NAN}}), ElementsAre(false, true, false));
}

TEST(Pareto, NothingGivesNothing) { EXPECT_TRUE(paretoFront({}).empty()); }

}  // namespace
}  // namespace ragdoll::lab
