#include "core/mechanics/pair_energy.h"

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

TEST(PairEnergy, IsTakenOutOfTheRelativeMotion) {
  World world = twoBalls();
  GroupScratch scratch;
  takeOutOfGroup(world.model, {0, 1}, false, 18, world.state, scratch);
  EXPECT_NEAR(kineticEnergy(world.model, world.state), 8, 1e-12);
  EXPECT_NEAR(momentum(world.model, world.state).x(), 4, 1e-12);
  EXPECT_NEAR(world.v(0).x(), 4, 1e-12);  // 1 + 6 sqrt(6 / 24)
  takeOutOfGroup(world.model, {0, 1}, false, 100, world.state, scratch);
  EXPECT_NEAR(kineticEnergy(world.model, world.state), 2, 1e-12);  // no more than there is
}

TEST(PairEnergy, IsTakenOutOfAllWhereSomethingHolds) {
  World world = twoBalls();
  GroupScratch scratch;
  takeOutOfGroup(world.model, {0, 1}, true, 19.5, world.state, scratch);
  EXPECT_NEAR(kineticEnergy(world.model, world.state), 6.5, 1e-12);
  EXPECT_NEAR(world.v(0).x(), 3.5, 1e-12);  // sqrt(6.5 / 26) of all velocities
}

}  // namespace
}  // namespace ragdoll
