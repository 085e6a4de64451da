#include "core/direct/island_builder.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// Balls of 0.1 m in a row; those that meet in the step take it together.
Scene rowOfBalls(const std::vector<double>& x, const std::vector<double>& v) {
  Scene scene = weightless(oneParticle(1, 0.1));
  const RagdollSpec ball = scene.ragdolls[0];
  scene.ragdolls.clear();
  for (std::size_t i = 0; i < x.size(); ++i) {
    scene.ragdolls.push_back(ball);
    scene.ragdolls.back().name = "ball" + std::to_string(i);
    scene.ragdolls.back().pose.position.x() = x[i];
    scene.ragdolls.back().velocity.x() = v[i];
  }
  scene.ragdoll_collision = true;
  return scene;
}

TEST(IslandBuilder, BodiesThatMeetPressOnEachOther) {
  DirectIsland all(rowOfBalls({0, 0.21, 5}, {6, 0, 1}));
  IslandBuilder builder;
  StepReport report;
  builder.step(all.context, report);
  ASSERT_FALSE(all.supports.pressing.empty());
  EXPECT_EQ(all.supports.pressing[0].first + all.supports.pressing[0].second, 1);
  EXPECT_NEAR(all.world.v(0).x() + all.world.v(1).x(), 6, 1e-12);
  EXPECT_NEAR(all.world.v(0).x(), all.world.v(1).x(), 1e-9);  // without restitution
  EXPECT_DOUBLE_EQ(all.world.v(2).x(), 1);
}

TEST(IslandBuilder, BodiesThatDoNotMeetStepAsIfAlone) {
  DirectIsland all(rowOfBalls({0, 1}, {1, -2}));
  IslandBuilder builder;
  StepReport report;
  builder.step(all.context, report);
  EXPECT_TRUE(all.supports.pressing.empty());
  EXPECT_DOUBLE_EQ(all.world.x(0).x(), all.h);
  EXPECT_DOUBLE_EQ(all.world.x(1).x(), 1 - 2 * all.h);
}

}  // namespace
}  // namespace ragdoll
