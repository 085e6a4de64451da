#include "ragdoll_sim/core/findings.h"

#include <gtest/gtest.h>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Findings, PointMassesWeightTheCentreOfMass) {
  SkeletonSpec s = oneStick(1, 0);
  s.segments[0].mass = 2;
  s.segments[0].com = 0.25;
  s.segments[0].gyration = 0.3;
  const World world(sceneOf(s));
  const Eigen::VectorXd m = pointMasses(world.model.skeletons[0]);
  EXPECT_NEAR(m[0], 1 + 1.5, 1e-14);
  EXPECT_NEAR(m[1], 0.5, 1e-14);
}

TEST(Findings, TellWhatIsDeepInAnObstacle) {
  Scene scene = sceneOf(oneParticle(1, 0.1), Vec3(0, 0, 0.1 - 0.06));
  scene.obstacles = {floorPlane()};
  const World deep(scene);
  const std::vector<std::string> found = deepOverlaps(deep.model, deep.state);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], "ragdoll is 6 cm inside plane_0");
  scene.ragdolls[0].pose.position.z() = 0.1;
  const World there(scene);
  EXPECT_TRUE(deepOverlaps(there.model, there.state).empty());
}

TEST(Findings, CountWhatASleeperLiesOn) {
  Scene scene = sceneOf(oneStick(1, 1, 0.1), Vec3(0, 0, 0.1));
  scene.obstacles = {floorPlane()};
  World world(scene);
  EXPECT_EQ(contactsOfSleepers(world.model, world.state), 0);
  world.state.asleep[0] = 1;
  EXPECT_EQ(contactsOfSleepers(world.model, world.state), 2);
}

}  // namespace
}  // namespace ragdoll
