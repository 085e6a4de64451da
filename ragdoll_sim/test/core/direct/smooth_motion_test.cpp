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

TEST(SmoothMotion, WithEventsGoesThroughAnImpact) {
  const double t = 0.004;
  Scene scene = ball(heightOf(t), 0);
  scene.solver.events = true;
  DirectIsland one(scene);
  save(one.island);
  const SmoothTrial trial = moveSmoothly(one.island, one.h);
  ASSERT_TRUE(trial.ok);
  EXPECT_EQ(trial.took, one.h);
  const double speed = 1 + 9.81 * t, left = one.h - t;
  EXPECT_NEAR(one.world.x(0).z(), 0.1 + speed * left - 0.5 * 9.81 * left * left, 1e-12);
  EXPECT_NEAR(one.world.v(0).z(), speed - 9.81 * left, 1e-12);
}

TEST(SmoothMotion, ThatIsFreeKnowsItsErrorAndOneThatIsNotIsNone) {
  double error = -1;
  DirectIsland high(ball(heightOf(1), 1e-6));
  EXPECT_TRUE(moveFreely(high.island, high.h, error));
  EXPECT_NEAR(error, 0, 1e-15);  // a parabola is exact
  EXPECT_NEAR(high.world.x(0).z(), 0.1 + heightOf(1) - heightOf(high.h), 1e-12);
  DirectIsland low(ball(heightOf(0.5 * high.h), 1e-6));
  EXPECT_FALSE(moveFreely(low.island, low.h, error));
}

}  // namespace
}  // namespace ragdoll
