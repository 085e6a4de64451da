#include "core/direct/rigid_fallback.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/core/measures.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// A chain that folds at 20 rad/s while it flies: as one piece it keeps its momentum and its
/// angular momentum.
TEST(RigidFallback, FreezesTheJointsInFlight) {
  DirectIsland one(weightless(chainOfThree(), Vec3(1, 2, 3)));
  one.body().v().row(1) += Eigen::RowVector3d(10, -20, 40);
  const Vec3 p = momentum(one.world.model, one.world.state);
  const Vec3 l = angularMomentum(one.world.model, one.world.state);
  moveRigidly(one.island, one.h, one.report);
  EXPECT_EQ(one.report.rigid, 1);
  const Points& x = one.world.state.x;
  EXPECT_NEAR((x.col(1) - x.col(0)).norm(), 1, 1e-12);
  EXPECT_NEAR((x.col(2) - x.col(0)).norm(), 2, 1e-12);
  EXPECT_LT((momentum(one.world.model, one.world.state) - p).norm(), 1e-9);
  EXPECT_LT((angularMomentum(one.world.model, one.world.state) - l).norm(), 1e-7);
}

TEST(RigidFallback, StandsAtTheFirstTouch) {
  Scene scene = weightless(oneStick(1, 1, 0.05), Vec3(0, 0, -100));
  scene.ragdolls[0].pose.position.z() = 0.3;
  scene.obstacles = {floorPlane()};
  DirectIsland one(scene);
  moveRigidly(one.island, one.h, one.report);
  EXPECT_GT(one.world.x(0).z(), 0.05 - 1e-3);
  EXPECT_LE(one.world.x(0).z(), 0.3);
}

}  // namespace
}  // namespace ragdoll
