#include "core/direct/begin_step.h"

#include <gtest/gtest.h>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(BeginStep, AcceleratesAndLeavesDampingToTheMotion) {
  Scene scene = sceneOf(oneParticle(2));
  scene.ragdolls[0].velocity.x() = 3;
  scene.solver.damping = 4;
  DirectIsland one(scene);  // begins a step
  EXPECT_DOUBLE_EQ(one.world.v(0).x(), 3);
  EXPECT_TRUE(one.body().damps_within);
  EXPECT_NEAR(one.body().acceleration(2, 0), -9.81, 1e-14);
  EXPECT_FALSE(one.body().driven);
}

TEST(BeginStep, PinsMoveToTheirTargets) {
  Scene scene = weightless(oneStick());
  PinSpec pin;
  pin.particle = "a";
  scene.pins = {pin};
  DirectIsland one(scene);
  one.world.inputs.pins = {Vec3(0, 0.01, 0)};
  beginStep(one.body(), one.report);
  EXPECT_NEAR(one.world.v(0).y(), 0.01 / one.h, 1e-12);
  EXPECT_NEAR(one.body().pin_speed, 0.01 / one.h, 1e-12);
  EXPECT_TRUE(one.body().driven);
}

}  // namespace
}  // namespace ragdoll
