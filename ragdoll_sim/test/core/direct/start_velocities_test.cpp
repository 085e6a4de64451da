#include "core/direct/start_velocities.h"

#include <gtest/gtest.h>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(StartVelocities, OfWhatIsConsistentNotABitChanges) {
  Scene scene = sceneOf(oneStick());
  scene.ragdolls[0].velocity = Vec3(1, 2, 3);
  scene.ragdolls[0].angular_velocity = Vec3(0, 1, 2);
  World world(scene);
  const Points before = world.state.v;
  EXPECT_EQ(makeConsistent(world.model, world.state), 0);
  EXPECT_EQ(world.state.v, before);
}

TEST(StartVelocities, AStickLosesWhatStretchesIt) {
  World world(sceneOf(oneStick(1, 3)));
  world.state.v.col(0) = Vec3(-4, 1, 0);
  // The ends go on with their common speed along the stick: 1 m/s to the left.
  EXPECT_NEAR(makeConsistent(world.model, world.state), 0.5 * 0.75 * 16, 1e-9);
  EXPECT_LT((world.v(0) - Vec3(-1, 1, 0)).norm(), 1e-9);
  EXPECT_LT((world.v(1) - Vec3(-1, 0, 0)).norm(), 1e-9);
}

}  // namespace
}  // namespace ragdoll
