#include "core/direct/island.h"

#include <gtest/gtest.h>

#include "core/direct/trial.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

Scene threeRods() {
  Scene scene = weightless(oneStick());
  for (const char* name : {"second", "third"}) {
    scene.ragdolls.push_back(scene.ragdolls[0]);
    scene.ragdolls.back().name = name;
  }
  return scene;
}

TEST(Island, KnowsItsBodies) {
  DirectIsland all(threeRods());
  EXPECT_FALSE(all.island.isLone());
  EXPECT_EQ(all.island.placeOf(2), 2);
  bindIsland(all.island, {0, 2}, {1});  // the second one sleeps
  EXPECT_EQ(all.island.bodies.size(), 2U);
  EXPECT_EQ(all.island.placeOf(1), -1);
  EXPECT_EQ(all.island.placeOf(2), 1);
  bindIsland(all.island, {1}, {});
  EXPECT_TRUE(all.island.isLone());
  EXPECT_EQ(all.body().first, 2);
}

TEST(Island, GoesBackToWhereItWasSaved) {
  DirectIsland one(weightless(oneStick(), Vec3(1, 2, 3)));
  const State before = one.world.state;
  save(one.island);
  takeExplicitTrial(one.island, one.h);
  EXPECT_GT((one.world.state.x - before.x).norm(), 1e-3);
  restore(one.island);
  EXPECT_EQ(one.world.state.x, before.x);
  EXPECT_EQ(one.world.state.v, before.v);
  EXPECT_EQ(one.world.state.multipliers, before.multipliers);
}

}  // namespace
}  // namespace ragdoll
