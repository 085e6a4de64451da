#include "core/direct/angular_momentum.h"

#include <gtest/gtest.h>

#include "core/direct/step_island.h"
#include "ragdoll_sim/core/measures.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// A weightless chain that turns, whose motion lost a part of its spin.
TEST(AngularMomentum, ComesBackAsASpinOfAll) {
  Scene scene = weightless(chainOfThree());
  scene.ragdolls[0].angular_velocity = Vec3(0.5, 1, 2);
  DirectIsland one(scene);
  save(one.island);
  const Vec3 before = angularMomentum(one.world.model, one.world.state);
  const Vec3 momentum0 = momentum(one.world.model, one.world.state);
  const Vec3 centre = centreOfMass(one.world.model, one.world.state, 0);
  for (int i = 0; i < 3; ++i)
    one.world.state.v.col(i) -= Vec3(0, 0, 0.4).cross(one.world.x(i) - centre);
  ASSERT_GT((angularMomentum(one.world.model, one.world.state) - before).norm(), 0.1);
  restoreAngularMomentum(one.island, one.h);
  EXPECT_LT((angularMomentum(one.world.model, one.world.state) - before).norm(), 1e-12);
  EXPECT_LT((momentum(one.world.model, one.world.state) - momentum0).norm(), 1e-12);
}

TEST(AngularMomentum, OfWhatIsHeldBelongsToItsPin) {
  Scene scene = weightless(chainOfThree());
  PinSpec pin;
  pin.particle = "ragdoll/a";
  scene.pins.push_back(pin);
  scene.ragdolls[0].angular_velocity = Vec3(0, 0, 2);
  DirectIsland one(scene);
  save(one.island);
  one.world.state.v *= 0.5;
  const Points v = one.world.state.v;
  restoreAngularMomentum(one.island, one.h);
  EXPECT_EQ(one.world.state.v, v);
}

TEST(AngularMomentum, NothingPressesOnAChainInTheAir) {
  DirectIsland one(weightless(chainOfThree()));
  EXPECT_FALSE(pressesItself(one.island));
}

}  // namespace
}  // namespace ragdoll
