// What a user sees over many falls with the default solver: joints hold, sticks hold, nothing sinks
// in, energy never rises, and bodies come to rest.
#include <gtest/gtest.h>

#include <random>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr int kFalls = 100;  ///< of each scene
constexpr double kSeconds = 10;

/// The shipped scene with its first ragdoll turned and thrown at random.
Scene randomFall(const std::string& name, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Scene scene = loadScene(name);
  scene.ragdolls.resize(1);
  scene.pokes.clear();
  RagdollSpec& r = scene.ragdolls[0];
  r.pose.orientation = Quat(unit(random), unit(random), unit(random), unit(random)).normalized() *
                       r.pose.orientation;
  r.pose.position.z() += 0.6;
  r.velocity += Vec3(unit(random), unit(random), unit(random));
  r.angular_velocity = 3 * Vec3(unit(random), unit(random), unit(random));
  return scene;
}

class Falls : public testing::TestWithParam<std::string> {};

TEST_P(Falls, HoldTheBodyTogetherAndEndAtRest) {
  std::mt19937 random(2007);
  int resting = 0;
  double limit = 0, stretch = 0, penetration = 0, rise = 0;
  for (int fall = 0; fall < kFalls; ++fall) {
    World world(randomFall(GetParam(), random));
    const auto energy = [&world] {
      return kineticEnergy(world.model, world.state) + potentialEnergy(world.model, world.state);
    };
    const double start = energy();
    const int steps = static_cast<int>(kSeconds / world.model.solver.step);
    for (int i = 0; i < steps && !world.state.asleep[0]; ++i) {
      world.steps(1);
      limit = std::max(limit, maxLimitViolation(world.model, world.state));
      stretch = std::max(stretch, maxStickError(world.model, world.state));
      penetration = std::max(penetration, maxPenetration(world.model, world.state));
      rise = std::max(rise, energy() - start);
    }
    resting += world.state.v.colwise().norm().maxCoeff() < 1e-3;
  }
  RecordProperty("limit_deg", std::to_string(limit * 180 / M_PI));
  RecordProperty("stretch", std::to_string(stretch));
  RecordProperty("penetration_mm", std::to_string(penetration * 1e3));
  RecordProperty("energy_rise_J", std::to_string(rise));
  RecordProperty("resting", resting);
  EXPECT_LT(limit * 180 / M_PI, 2);
  EXPECT_LT(stretch, 1e-3);
  EXPECT_LT(penetration, 1e-3);
  EXPECT_LT(rise, 1e-2);
  EXPECT_GT(resting, 95 * kFalls / 100);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Falls, testing::Values("stairs", "between_objects"));

}  // namespace
}  // namespace ragdoll
