// What every shipped scene must keep from start to end, with its own settings and with the source's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "ragdoll_sim/core/distance.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

constexpr double kSeconds = 8;

/// [m] by how much the sticks, as capsules between their ends' spheres, reach into obstacles.
double stickPenetration(const Model& model, const State& state) {
  constexpr int kPlaces = 20;  ///< along a stick
  double worst = 0;
  for (std::size_t k = 0; k < model.obstacles.size(); ++k) {
    const Pose& pose = state.obstacles[k];
    const Eigen::Matrix3d R = pose.orientation.toRotationMatrix();
    for (const Ragdoll& r : model.ragdolls)
      for (const Stick& s : model.skeletonOf(r).sticks)
        for (int i = 0; i <= kPlaces; ++i) {
          const double t = static_cast<double>(i) / kPlaces;
          const int a = r.first + s.a, b = r.first + s.b;
          const Vec3 p = (1 - t) * state.x.col(a) + t * state.x.col(b);
          const double radius = (1 - t) * model.radius[a] + t * model.radius[b];
          const double gap =
              signedDistance(model.obstacles[k], R.transpose() * (p - pose.position)).value;
          worst = std::max(worst, radius - gap);
        }
  }
  return worst;
}

class ShippedScene : public testing::TestWithParam<const char*> {};

TEST_P(ShippedScene, EndsOutsideOfEveryObstacleWithItsSticksWhole) {
  test::World world(loadScene(GetParam()));
  world.steps(static_cast<int>(kSeconds / world.model.solver.step));
  ASSERT_TRUE(world.state.x.allFinite() && world.state.v.allFinite());
  EXPECT_LT(maxPenetration(world.model, world.state), 1e-3);
  EXPECT_LT(stickPenetration(world.model, world.state), 5e-3);
  EXPECT_LT(maxStickError(world.model, world.state), 1e-3);
}

TEST_P(ShippedScene, EndsOutsideOfEveryObstacleByRelaxation) {
  Scene scene = loadScene(GetParam());
  applySetting(scene, "solver.preset", "thesis");
  test::World world(scene);
  world.steps(static_cast<int>(kSeconds / world.model.solver.step));
  ASSERT_TRUE(world.state.x.allFinite() && world.state.v.allFinite());
  EXPECT_LT(maxPenetration(world.model, world.state), 5e-3);
  EXPECT_LT(stickPenetration(world.model, world.state), 2e-2);
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
                         testing::Values("fall", "stairs", "between_objects", "hang",
                                         "weightless"),
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
  EXPECT_NEAR(stickPenetration(world.model, world.state), 0.25, 1e-9);
}

}  // namespace
}  // namespace ragdoll
