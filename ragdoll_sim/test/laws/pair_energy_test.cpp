// Humans thrown at each other: contact takes energy and gives none, and momentum stays.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/samples.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

class PairEnergy : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Presets, PairEnergy, testing::Values("thesis", "balanced"),
                         [](const auto& info) { return std::string(info.param); });

/// Two humans, turned at random, weightless; the second comes down on the first.
Scene twoThatMeet(const char* solver, double speed, unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&random](double reach) {
    return reach * (2 * (static_cast<double>(random()) / 4294967296.0) - 1);
  };
  Scene scene = parseScene(
      "gravity: [0, 0, 0]\nragdoll_collision: true\n"
      "ragdolls: [{name: a, model: human}, {name: b, model: human}]\n",
      "thrown");
  scene.solver = preset(solver);
  for (RagdollSpec& r : scene.ragdolls)
    r.pose.orientation = Quat(Eigen::AngleAxisd(uniform(M_PI), Vec3::UnitZ())) *
                         Quat(Eigen::AngleAxisd(uniform(M_PI), Vec3::UnitY()));
  scene.ragdolls[1].pose.position = Vec3(uniform(0.4), uniform(0.4), 2.2);
  scene.ragdolls[1].velocity = Vec3(0, 0, -speed);
  return scene;
}

TEST_P(PairEnergy, NeverRisesAndMomentumStays) {
  for (const double speed : {3.0, 30.0}) {
    double lost = 0;
    for (int seed = 0; seed < samples(60); ++seed) {
      World world(twoThatMeet(GetParam(), speed, seed));
      const double before = kineticEnergy(world.model, world.state);
      const Vec3 momentum_before = momentum(world.model, world.state);
      double most = 0;
      for (int i = 0; i < 0.5 / world.model.solver.step; ++i) {
        world.steps(1);
        most = std::max(most, kineticEnergy(world.model, world.state));
      }
      EXPECT_LT(most / before - 1, 1e-9) << speed << " m/s, seed " << seed;
      EXPECT_LT((momentum(world.model, world.state) - momentum_before).norm(),
                1e-9 * momentum_before.norm())
          << speed << " m/s, seed " << seed;
      lost = std::max(lost, 1 - kineticEnergy(world.model, world.state) / before);
    }
    EXPECT_GT(lost, 0.1) << speed << " m/s: nobody was hit";
  }
}

}  // namespace
}  // namespace ragdoll
