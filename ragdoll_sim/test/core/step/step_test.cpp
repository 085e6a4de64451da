#include "ragdoll_sim/core/step.h"

#include <gtest/gtest.h>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Step, AdvancesTimeAndCount) {
  World world(sceneOf(oneParticle()));
  world.steps(120);
  EXPECT_EQ(world.state.step, 120U);
  EXPECT_NEAR(world.state.time, 120 * world.model.solver.step, 1e-12);
}

/// Every method falls alike in one step from rest, but for its order.
TEST(Step, HasAllMethods) {
  for (const Method method : {Method::kJakobsen, Method::kShake, Method::kRk, Method::kFast}) {
    Scene scene = sceneOf(oneStick());
    scene.solver.method = method;
    World world(scene);
    world.steps(30);
    EXPECT_NEAR(world.x(0).z(), -0.5 * 9.81 * 0.25, 0.05) << static_cast<int>(method);
  }
}

TEST(Step, StateAndWorkspaceAreApart) {
  Scene scene = sceneOf(oneStick(1, 2, 0.05), Vec3(0, 0, 0.2));
  scene.obstacles = {floorPlane(0.5, 0.3)};
  World one(scene), other(scene);
  one.steps(50);
  other.steps(20);
  other.workspace = Workspace();  // nothing in it matters
  other.steps(30);
  EXPECT_EQ(one.state.x, other.state.x);
  EXPECT_EQ(one.state.v, other.state.v);
}

}  // namespace
}  // namespace ragdoll
