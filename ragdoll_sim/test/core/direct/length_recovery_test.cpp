#include "core/direct/length_recovery.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/constants.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(LengthRecovery, DrawsInExponentiallyWithoutSpeed) {
  DirectIsland one(weightless(oneStick()));
  Body& body = one.body();
  EXPECT_FALSE(restoreLengths(body, one.h));
  EXPECT_TRUE(body.isWhole());
  body.x().col(1) *= 2;  // 1 m too long
  EXPECT_TRUE(restoreLengths(body, one.h));
  const double length = 1 + std::exp(-one.h / kRecoveryTime);
  EXPECT_NEAR((body.x().col(1) - body.x().col(0)).norm(), length, 1e-9);
  EXPECT_NEAR(body.x().row(0).sum(), 2, 1e-12);  // equal masses: the middle stays
  EXPECT_EQ(body.v().norm(), 0);
  EXPECT_FALSE(body.isWhole());
  EXPECT_NEAR(body.lengths.length2[0], length * length, 1e-9);  // kept in this step
}

}  // namespace
}  // namespace ragdoll
