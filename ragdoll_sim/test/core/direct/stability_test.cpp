#include "core/direct/stability.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/constants.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// A stick of 1 m between 1 kg and 3 kg under a tension T is a spring across itself: its ends swing
/// with Omega^2 = T (1/1 + 1/3) / 1 m, and the bound is twice that.
TEST(Stability, BoundsTheFrequencyOfAStickUnderTension) {
  constexpr double kTension = 90;
  DirectIsland one(weightless(oneStick(1, 3)));
  one.body().multipliers()[0] = -kTension;
  const double omega2 = kTension * (1 + 1.0 / 3);
  EXPECT_NEAR(stiffness(one.body()), 2 * omega2, 1e-9);
  const double stable = kStable / std::sqrt(2 * omega2);  // [s]
  EXPECT_TRUE(isSoft(one.body(), 0.99 * stable));
  EXPECT_FALSE(isSoft(one.body(), 1.01 * stable));
  EXPECT_FALSE(exceedsStable(one.body(), 0.99 * stable, 1));
  EXPECT_TRUE(exceedsStable(one.body(), 1.01 * stable, 1));
}

TEST(Stability, TensionThatQuadrupledHasJumped) {
  DirectIsland one(weightless(oneStick()));
  double& multiplier = one.body().multipliers()[0];
  multiplier = -100;
  save(one.island);
  const double h = kStable / std::sqrt(stiffness(one.body()));
  multiplier = -399;
  EXPECT_FALSE(tensionJumped(one.body(), h));
  multiplier = -401;
  EXPECT_TRUE(tensionJumped(one.body(), h));
}

}  // namespace
}  // namespace ragdoll
