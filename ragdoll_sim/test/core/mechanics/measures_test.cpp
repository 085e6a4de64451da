#include "ragdoll_sim/core/measures.h"

#include <gtest/gtest.h>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Measures, AreThoseOfTwoMasses) {
  Scene scene = sceneOf(oneStick(1, 3, 0.1), Vec3(0, 0, 2));
  scene.obstacles = {floorPlane()};
  World world(scene);
  world.state.v.col(0) = Vec3(0, 2, 0);
  world.state.v.col(1) = Vec3(0, 0, -4);
  EXPECT_NEAR(kineticEnergy(world.model, world.state), 0.5 * 4 + 0.5 * 3 * 16, 1e-12);
  EXPECT_NEAR(potentialEnergy(world.model, world.state), 4 * 9.81 * 2, 1e-12);
  EXPECT_LT((centreOfMass(world.model, world.state, 0) - Vec3(0.75, 0, 2)).norm(), 1e-12);
  EXPECT_LT((momentum(world.model, world.state) - Vec3(0, 2, -12)).norm(), 1e-12);
  // (0, 0, 2) x (0, 2, 0) + (1, 0, 2) x (0, 0, -12)
  EXPECT_LT((angularMomentum(world.model, world.state) - Vec3(-4, 12, 0)).norm(), 1e-12);
  EXPECT_NEAR(maxStickError(world.model, world.state), 0, 1e-15);
  EXPECT_EQ(maxPenetration(world.model, world.state), 0);
  world.state.x.col(1) = Vec3(1.2, 0, 2);
  EXPECT_NEAR(maxStickError(world.model, world.state), 0.2, 1e-12);
  world.state.x.row(2).setConstant(0.07);
  EXPECT_NEAR(maxPenetration(world.model, world.state), 0.03, 1e-12);
}

TEST(Measures, HashTellsTheLastBit) {
  World world(sceneOf(oneStick()));
  const std::uint64_t before = hash(world.state);
  world.state.v(0, 0) = 1e-300;
  EXPECT_NE(hash(world.state), before);
  world.state.v(0, 0) = 0;
  EXPECT_EQ(hash(world.state), before);
}

}  // namespace
}  // namespace ragdoll
