#include "core/direct/adaptive_step.h"

#include <gtest/gtest.h>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kTolerance = 1e-4;  ///< [m/s]

Scene withTolerance(Scene scene, Method method) {
  scene.solver.method = method;
  scene.solver.step = 0.1;
  scene.solver.tolerance = kTolerance;
  return scene;
}

struct Stepped : DirectIsland {
  explicit Stepped(const Scene& scene) : DirectIsland(scene) {
    std::vector<int> all(world.model.ragdolls.size());
    std::iota(all.begin(), all.end(), 0);
    report = {};
    stepWithinTolerance(context, all, {}, report);
  }
};

TEST(AdaptiveStep, OfAFreeFallIsExact) {
  for (const Method method : {Method::kShake, Method::kRk}) {
    Scene scene = withTolerance(sceneOf(oneStick(), Vec3(0, 0, 5)), method);
    scene.ragdolls[0].velocity = Vec3(1, 0, 2);
    const Stepped one(scene);
    const double z = 5 + 2 * 0.1 - 0.5 * 9.81 * 0.01;
    EXPECT_LT((one.world.x(0) - Vec3(0.1, 0, z)).norm(), 1e-12);
    EXPECT_LT((one.world.v(1) - Vec3(1, 0, 2 - 0.981)).norm(), 1e-12);
    EXPECT_LT(one.report.error_estimate, 1e-9);
    EXPECT_EQ(one.report.tolerance_missed, 0);
  }
}

/// A rod spins about its middle at 10 rad/s: it turns by 1 rad in the step.
TEST(AdaptiveStep, TakesThePartsThatTheToleranceNeeds) {
  for (const Method method : {Method::kShake, Method::kRk}) {
    Scene scene = withTolerance(weightless(oneStick()), method);
    scene.ragdolls[0].angular_velocity = Vec3(0, 0, 10);
    const Stepped one(scene);
    const Vec3 along = one.world.x(1) - one.world.x(0);
    EXPECT_LT((along - Vec3(std::cos(1.0), std::sin(1.0), 0)).norm(), 3 * kTolerance * 0.1);
    EXPECT_GT(one.report.substeps, 1);
    EXPECT_LE(one.report.error_estimate, kTolerance);
    EXPECT_GT(one.report.error_estimate, 0);
    EXPECT_EQ(one.report.tolerance_missed, 0);
  }
}

/// Restitution 1: a ball of 0.1 m, 0.3 m above a floor, at 6 m/s down, is 0.1 m above it again.
TEST(AdaptiveStep, GoesThroughAnImpact) {
  Scene scene = withTolerance(weightless(oneParticle(1, 0.1), Vec3(0, 0, -6)), Method::kShake);
  scene.ragdolls[0].pose.position.z() = 0.4;
  scene.obstacles = {floorPlane(0, 1)};
  const Stepped one(scene);
  EXPECT_NEAR(one.world.x(0).z(), 0.1 + 0.3, 3 * kTolerance * 0.1);
  EXPECT_NEAR(one.world.v(0).z(), 6, 1e-9);
  EXPECT_EQ(one.report.tolerance_missed, 0);
}

/// A pin and a box that go along: the parts lead them, and the islands that follow find the box as
/// it was.
TEST(AdaptiveStep, LeadsWhatIsDrivenAndPutsObstaclesBack) {
  Scene scene = withTolerance(weightless(oneStick()), Method::kShake);
  PinSpec pin;
  pin.particle = "a";
  scene.pins = {pin};
  ObstacleSpec box;
  box.type = ObstacleSpec::Type::kBox;
  box.size = Vec3(1, 1, 1);
  box.pose.position = Vec3(0, 0, -5);
  box.frame = "cart";
  scene.obstacles = {box};
  DirectIsland one(scene);
  one.world.inputs.pins.assign(1, Vec3(0, 0.3, 0));
  one.world.inputs.obstacles.assign(1, scene.obstacles[0].pose);
  one.world.inputs.obstacles[0].position.x() = 0.3;
  const Vec3 before = one.world.state.obstacles[0].position;
  prepareDirect(one.context);
  stepWithinTolerance(one.context, {0}, {}, one.report);
  EXPECT_LT((one.world.x(0) - Vec3(0, 0.3, 0)).norm(), 1e-12);
  EXPECT_EQ(one.world.state.obstacles[0].position, before);
  EXPECT_NEAR((one.world.x(1) - one.world.x(0)).norm(), 1, 1e-9);
  EXPECT_GT(one.report.substeps, 1);
}

}  // namespace
}  // namespace ragdoll
