#include "core/direct/step_island.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/core/measures.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// Five bounces in one step, between a floor and a ceiling: each impact ends a substep.
TEST(StepIsland, TakesEveryImpactOfAStep) {
  Scene scene = weightless(oneParticle(1, 0.1), Vec3(0, 0, -60));
  scene.ragdolls[0].pose.position.z() = 0.2;  // a gap of 0.1 m to the floor, as much to the ceiling
  ObstacleSpec ceiling = floorPlane(0, 1);
  ceiling.pose.position.z() = 0.4;
  ceiling.normal = -Vec3::UnitZ();
  scene.obstacles = {floorPlane(0, 1), ceiling};
  DirectIsland one(scene);
  takeSubsteps(one.island, one.h, one.report);
  // 1 m of way: impacts after 0.1, 0.3, 0.5, 0.7 and 0.9 m, the last on the floor.
  EXPECT_NEAR(one.world.v(0).z(), 60, 1e-9);
  EXPECT_NEAR(one.world.x(0).z(), 0.2, 1e-9);
  EXPECT_GE(one.report.substeps, 5);
}

double totalEnergy(const World& world) {
  return kineticEnergy(world.model, world.state) + potentialEnergy(world.model, world.state);
}

TEST(StepIsland, AFreeBodyTakesOneStep) {
  DirectIsland one(sceneOf(oneStick(), Vec3(0, 0, 1)));
  const double before = totalEnergy(one.world);
  stepIsland(one.island, one.report);
  EXPECT_EQ(one.report.substeps, 1);
  EXPECT_NEAR(totalEnergy(one.world), before, 1e-12);
}

}  // namespace
}  // namespace ragdoll
