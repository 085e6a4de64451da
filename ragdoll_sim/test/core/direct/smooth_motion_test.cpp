#include "core/direct/smooth_motion.h"

#include <gtest/gtest.h>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

Scene ball(double height, double tolerance) {
  Scene scene = sceneOf(oneParticle(1, 0.1), Vec3(0, 0, 0.1 + height));
  scene.ragdolls[0].velocity.z() = -1;
  scene.obstacles = {floorPlane(0, 1)};
  scene.solver.method = Method::kRk;
  scene.solver.tolerance = tolerance;
  return scene;
}

/// Heights that it takes the ball a time t to fall through.
double heightOf(double t) { return t + 0.5 * 9.81 * t * t; }

TEST(SmoothMotion, GoesAsFarAsTheFirstImpact) {
  const double t = 0.004;
  DirectIsland one(ball(heightOf(t), 0));
  save(one.island);
  const SmoothTrial trial = moveSmoothly(one.island, one.h);
  ASSERT_TRUE(trial.ok);
  EXPECT_NEAR(trial.took, t, 1e-9);
  EXPECT_NEAR(one.world.x(0).z(), 0.1, 1e-9);
  EXPECT_NEAR(one.world.v(0).z(), 1 + 9.81 * t, 1e-7);
}

TEST(SmoothMotion, GoesOnAfterIt) {
  const double t = 0.004;
  DirectIsland one(ball(heightOf(t), 1e-6));
  stepWithinTolerance(one.island, one.h, one.report);
  const double left = one.h - t, up = 1 + 9.81 * t;
  EXPECT_NEAR(one.world.x(0).z(), 0.1 + up * left - 0.5 * 9.81 * left * left, 1e-8);
  EXPECT_GE(one.report.substeps, 2);
}

}  // namespace
}  // namespace ragdoll
