#include "core/direct/driving.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Driving, APinThatMovesIsNotDampedAndCarriesWhatItHolds) {
  Scene scene = weightless(oneStick());
  PinSpec pin;
  pin.particle = "a";
  scene.pins = {pin};
  scene.solver.damping = 3;
  DirectIsland one(scene);
  one.world.state.v.col(0) = one.world.state.v.col(1) = Vec3(0, 0.5, 0);
  damp(one.body(), 0.1);
  EXPECT_EQ(one.world.v(0), Vec3(0, 0.5, 0));
  EXPECT_NEAR(one.world.v(1).y(), 0.5 * std::exp(-0.3), 1e-14);  // free of the pin's way: lumped
}

TEST(Driving, TheForceOfAPokeOffItsPointFollowsThePose) {
  Scene scene = weightless(oneStick());
  PokeSpec poke;
  poke.body = "ab";
  poke.force = Vec3(0, 2, 0);
  poke.point = Vec3(0.25, 0, 0);
  poke.duration = 1;
  scene.pokes = {poke};
  World world(scene);
  Points force = Points::Zero(3, 2);
  addForce(world.inputs.pokes[0], world.state, force);
  EXPECT_NEAR(force(1, 1) - force(1, 0), 1, 1e-12);  // 0.5 N m at a lever of 0.5 m each
  Points turned(3, 2);
  turned << 0.5, 0.5, -0.5, 0.5, 0, 0;  // along y: no moment about it is left for the force to have
  force.setZero();
  addForce(world.inputs.pokes[0], turned, 0, force);
  EXPECT_NEAR(force(0, 1) - force(0, 0), -1, 1e-12);
  EXPECT_NEAR(force.row(1).sum(), 2, 1e-12);
}

}  // namespace
}  // namespace ragdoll
