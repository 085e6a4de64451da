#include "core/direct/energy.h"

#include <gtest/gtest.h>

#include "core/direct/trial.h"
#include "ragdoll_sim/core/measures.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Energy, AFallGainsNothing) {
  Scene scene = sceneOf(oneStick(1, 3));
  scene.ragdolls[0].velocity = Vec3(3, 0, 4);
  DirectIsland one(scene);
  EXPECT_NEAR(kineticEnergy(one.body()), 0.5 * 4 * 25, 1e-12);
  save(one.island);
  EXPECT_TRUE(takeExplicitTrial(one.island, one.h).ok);
  EXPECT_NEAR(gainedEnergy(one.body(), one.h, 0), 0, 1e-12);
  one.body().v() *= 2;  // from nowhere
  EXPECT_NEAR(gainedEnergy(one.body(), one.h, 0), 0.75 * kineticEnergy(one.body()), 1e-9);
}

/// A chain that bends while it flies: what bends it has 3 J.
TEST(Energy, IsRemovedFromTheInnerMotionAndMomentumStays) {
  DirectIsland one(weightless(chainOfThree(), Vec3(5, 0, 0)));
  one.body().v().row(1) << 1, -2, 1;
  save(one.island);
  const double before = kineticEnergy(one.body());
  const Vec3 momentum_before = momentum(one.world.model, one.world.state);
  EXPECT_TRUE(removeEnergy(one.island, 2, 0));
  EXPECT_NEAR(kineticEnergy(one.body()), before - 2, 1e-9);
  EXPECT_LT((momentum(one.world.model, one.world.state) - momentum_before).norm(), 1e-12);
  EXPECT_FALSE(removeEnergy(one.island, 5, 0));  // the rest is its flight
  EXPECT_LT((momentum(one.world.model, one.world.state) - momentum_before).norm(), 1e-12);
}

/// A flight of 37.5 J and a bending of 0.3 MJ from nowhere: 19 J of it that do not come out again
/// are half of the flight, however small beside what was gained.
TEST(Energy, WhatWasGainedIsNoMeasureOfWhatMayBeLeft) {
  DirectIsland one(weightless(chainOfThree(), Vec3(5, 0, 0)));
  save(one.island);
  const double before = kineticEnergy(one.body());
  one.body().v().row(1) += 300 * Eigen::RowVector3d(1, -2, 1);
  EXPECT_FALSE(removeEnergy(one.island, kineticEnergy(one.body()) - 0.5 * before, 0));
}

}  // namespace
}  // namespace ragdoll
