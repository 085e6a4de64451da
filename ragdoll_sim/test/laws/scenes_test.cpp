// What every shipped scene must keep from start to end, with its own settings and with the
// source's.
#include <gtest/gtest.h>

#include <string>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

constexpr double kSceneSeconds = 8;

class ShippedScene : public testing::TestWithParam<const char*> {};

TEST_P(ShippedScene, EndsOutsideOfEveryObstacleWithItsSticksWhole) {
  test::World world(loadScene(GetParam()));
  world.steps(static_cast<int>(kSceneSeconds / world.model.solver.step));
  ASSERT_TRUE(world.state.x.allFinite() && world.state.v.allFinite());
  EXPECT_LT(maxPenetration(world.model, world.state), 1e-3);
  EXPECT_LT(maxStickPenetration(world.model, world.state), 1e-3);
  EXPECT_LT(maxStickError(world.model, world.state), 1e-3);
}

TEST_P(ShippedScene, EndsOutsideOfEveryObstacleByRelaxation) {
  Scene scene = loadScene(GetParam());
  applySetting(scene, "solver.preset", "thesis");
  test::World world(scene);
  world.steps(static_cast<int>(kSceneSeconds / world.model.solver.step));
  ASSERT_TRUE(world.state.x.allFinite() && world.state.v.allFinite());
  EXPECT_LT(maxPenetration(world.model, world.state), 5e-3);
  EXPECT_LT(maxStickPenetration(world.model, world.state), 2e-2);
  EXPECT_LT(maxStickError(world.model, world.state), 5e-2);
}

TEST_P(ShippedScene, RunsTwiceToTheSameBits) {
  const Scene scene = loadScene(GetParam());
  test::World a(scene), b(scene);
  const int steps = static_cast<int>(2 / a.model.solver.step);
  a.steps(steps);
  b.steps(steps);
  EXPECT_EQ(hash(a.state), hash(b.state));
}

INSTANTIATE_TEST_SUITE_P(Scenes, ShippedScene,
                         testing::Values("fall", "stairs", "between_objects", "hang", "weightless"),
                         [](const auto& info) { return std::string(info.param); });

TEST(StickPenetration, IsTheDepthBetweenTheEndsThatParticlesDoNotShow) {
  // A stick of radius 0.1 through a ball of radius 0.35 that its ends miss: 0.2 m above its centre.
  Scene scene = test::sceneOf(test::oneStick(1, 1, 0.1), Vec3(-0.5, 0, 0.2));
  ObstacleSpec ball;
  ball.type = ObstacleSpec::Type::kSphere;
  ball.radius = 0.35;
  scene.obstacles = {ball};
  const test::World world(scene);
  EXPECT_EQ(maxPenetration(world.model, world.state), 0);
  EXPECT_NEAR(maxStickPenetration(world.model, world.state), 0.25, 1e-9);
}

}  // namespace
}  // namespace ragdoll
