#include "core/direct/saved_motion.h"

#include <gtest/gtest.h>

#include <vector>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// One of two rods is taken back; the other one stays where it has gone.
TEST(SavedMotion, TakesBackOneRagdollAlone) {
  Scene scene = sceneOf(oneStick());
  scene.ragdolls.push_back(scene.ragdolls[0]);
  scene.ragdolls[0].name = "first";
  scene.ragdolls[1].name = "second";
  scene.ragdolls[1].pose.position = Vec3(0, 5, 0);
  DirectIsland one(scene);
  State& state = one.world.state;
  for (std::size_t k = 0; k < state.multipliers.size(); ++k) state.multipliers[k] = 1.0 + k;
  const State before = state;
  std::vector<SavedMotion> saved;
  makeRoom(one.world.model, saved);
  for (int k = 0; k < 2; ++k) save(one.context, k, saved[k]);
  state.x.array() += 1;
  state.v.array() += 2;
  for (double& multiplier : state.multipliers) multiplier += 100;
  const State moved = state;

  restore(one.context, 1, saved[1]);
  EXPECT_EQ(state.x.leftCols(2), moved.x.leftCols(2));
  EXPECT_EQ(state.v.leftCols(2), moved.v.leftCols(2));
  EXPECT_EQ(state.x.rightCols(2), before.x.rightCols(2));
  EXPECT_EQ(state.v.rightCols(2), before.v.rightCols(2));
  const std::size_t own = state.multipliers.size() / 2;
  for (std::size_t k = 0; k < own; ++k) {
    EXPECT_EQ(state.multipliers[k], moved.multipliers[k]);
    EXPECT_EQ(state.multipliers[own + k], before.multipliers[own + k]);
  }
}

}  // namespace
}  // namespace ragdoll
