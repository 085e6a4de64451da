#include "core/direct/impact.h"

#include <gtest/gtest.h>

#include "core/direct/candidates.h"
#include "core/direct/motion.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Impact, TimeOfZeroIsTheParabolasFirstRoot) {
  EXPECT_DOUBLE_EQ(timeOfZero(0.6, -2.3, -0.7, 1), 0.3);          // (t - 0.3) (t - 2)
  EXPECT_DOUBLE_EQ(timeOfZero(1, -2, -1, 1), 0.5);                // a line
  EXPECT_NEAR(timeOfZero(4.905, 0, 4.905 - 19.62, 2), 1, 1e-15);  // a fall
  EXPECT_EQ(timeOfZero(-1e-9, -1, -1, 1), 0);                     // there already
}

TEST(Impact, IsLocatedWhereABallMeetsTheFloor) {
  constexpr double kSpeed = 12, kHeight = 0.1;
  Scene scene = weightless(oneParticle(), Vec3(0, 0, -kSpeed));
  scene.ragdolls[0].pose.position.z() = kHeight;
  scene.obstacles = {floorPlane()};
  DirectIsland one(scene);
  freeMotion(one.body(), one.h);
  findCandidates(one.island, one.h);
  findComing(one.island, one.h);
  EXPECT_TRUE(reachesComing(one.island));
  const Impact first = firstImpact(one.island, one.h);
  EXPECT_NEAR(first.time, kHeight / kSpeed, 1e-12);
  takeImpact(one.island, first);
  EXPECT_EQ(one.body().constraints.role[0], Role::kHit);
}

}  // namespace
}  // namespace ragdoll
