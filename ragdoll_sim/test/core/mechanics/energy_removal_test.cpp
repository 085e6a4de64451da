#include "core/mechanics/energy_removal.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/core/measures.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// Balls of 1 kg and 3 kg at 7 m/s and -1 m/s: 26 J, of which 2 J are their centre's at 1 m/s.
World twoBalls() {
  Scene scene = sceneOf(oneParticle(1));
  scene.ragdolls[0].velocity.x() = 7;
  scene.ragdolls.push_back(sceneOf(oneParticle(3)).ragdolls[0]);
  scene.ragdolls[1].name = "other";
  scene.ragdolls[1].velocity.x() = -1;
  return World(scene);
}

double takeOut(World& world, const std::vector<int>& bodies, bool held, double gain,
               RemovalScratch& scratch) {
  return takeEnergyOut(world.model, bodies, held, gain, world.state.x, world.state.v, scratch);
}

TEST(EnergyRemoval, IsTakenOutOfTheRelativeMotion) {
  World world = twoBalls();
  RemovalScratch scratch;
  takeOut(world, {0, 1}, false, 18, scratch);
  EXPECT_NEAR(kineticEnergy(world.model, world.state), 8, 1e-12);
  EXPECT_NEAR(momentum(world.model, world.state).x(), 4, 1e-12);
  EXPECT_NEAR(world.v(0).x(), 4, 1e-12);  // 1 + 6 sqrt(6 / 24)
  EXPECT_NEAR(takeOut(world, {0, 1}, false, 100, scratch), 94, 1e-12);
  EXPECT_NEAR(kineticEnergy(world.model, world.state), 2, 1e-12);  // no more than there is
}

/// Balls that turn about each other and draw apart: only that they draw apart is theirs to lose.
TEST(EnergyRemoval, AngularMomentumStays) {
  World world = twoBalls();
  world.state.x.col(0) = Vec3(0, 1.5, 0);
  world.state.x.col(1) = Vec3(0, -0.5, 0);
  world.state.v.col(0) = Vec3(3, 6, 0);
  world.state.v.col(1) = Vec3(-1, -2, 0);
  RemovalScratch scratch;
  EXPECT_NEAR(takeOut(world, {0, 1}, false, 50, scratch), 26, 1e-9);
  EXPECT_LT((world.v(0) - Vec3(3, 0, 0)).norm(), 1e-9);
  EXPECT_LT((world.v(1) - Vec3(-1, 0, 0)).norm(), 1e-9);
}

/// A bone that tumbles in flight has nothing to give; one body is no other case than two.
TEST(EnergyRemoval, LeavesARigidFlight) {
  World world(sceneOf(oneStick(1, 3)));
  world.state.v.col(0) = Vec3(1, 0, 2);
  world.state.v.col(1) = Vec3(1, 3, -1);
  const Points before = world.state.v;
  RemovalScratch scratch;
  EXPECT_NEAR(takeOut(world, {0}, false, 1, scratch), 1, 1e-9);
  EXPECT_LT((world.state.v - before).norm(), 1e-7);
}

TEST(EnergyRemoval, IsTakenOutOfAllWhereSomethingHolds) {
  World world = twoBalls();
  RemovalScratch scratch;
  takeOut(world, {0, 1}, true, 19.5, scratch);
  EXPECT_NEAR(kineticEnergy(world.model, world.state), 6.5, 1e-12);
  EXPECT_NEAR(world.v(0).x(), 3.5, 1e-12);  // sqrt(6.5 / 26) of all velocities
}

}  // namespace
}  // namespace ragdoll
