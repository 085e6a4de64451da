#include "core/direct/direct_step.h"

#include <gtest/gtest.h>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(DirectStep, PredictsWithoutWhatIsMet) {
  Scene scene = weightless(oneParticle(1, 0.1), Vec3(0, 0, -30));
  scene.ragdolls[0].pose.position.z() = 0.2;
  scene.obstacles = {floorPlane()};
  DirectIsland one(scene);
  predictFreely(one.context, 0);
  EXPECT_NEAR(one.world.x(0).z(), 0.2 - 30 * one.h, 1e-12);  // through the floor
}

TEST(DirectStep, LeavesSleepers) {
  Scene scene = weightless(oneParticle(), Vec3(1, 0, 0));
  scene.ragdolls.push_back(scene.ragdolls[0]);
  scene.ragdolls[1].name = "sleeper";
  DirectIsland two(scene);
  two.world.state.asleep[1] = 1;
  stepDirect(two.context, two.report);
  EXPECT_NEAR(two.world.x(0).x(), two.h, 1e-15);
  EXPECT_EQ(two.world.x(1).x(), 0);
}

}  // namespace
}  // namespace ragdoll
