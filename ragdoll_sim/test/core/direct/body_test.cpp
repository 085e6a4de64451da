#include "core/direct/body.h"

#include <gtest/gtest.h>

#include "core/direct/motion.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Body, IsAViewOfItsPartOfTheState) {
  Scene scene = weightless(oneParticle());
  scene.ragdolls.push_back(weightless(oneStick()).ragdolls[0]);
  scene.ragdolls[1].name = "stick";
  DirectIsland two(scene);
  Body& stick = *two.island.bodies[1];
  EXPECT_EQ(stick.first, 1);
  EXPECT_EQ(stick.n, 2);
  EXPECT_TRUE(stick.isWhole());
  EXPECT_EQ(multiplierCount(*stick.rows), 3);
  stick.v()(0, 1) = 7;
  EXPECT_EQ(two.world.v(2).x(), 7);
}

TEST(Body, PoseAfterIsWhereTheMotionLeads) {
  DirectIsland one(weightless(oneStick(), Vec3(3, 0, 0)));
  ASSERT_TRUE(freeMotion(one.body(), one.h));
  EXPECT_NEAR(poseAfter(one.body())(0, 1), 1 + 3 * one.h, 1e-14);
}

}  // namespace
}  // namespace ragdoll
