// `method: rk` from event to event within a tolerance: pieces are as long as it allows, and what
// shake takes is told. docs/equations.md#tolerance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/across_slope.h"
#include "support/event_steps.h"
#include "support/gravity.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

struct Told {
  int handed_over = 0, missed = 0;
  double largest = 0;  ///< [m/s] estimate
};

Told told(World& world, int steps) {
  Told all;
  for (int i = 0; i < steps; ++i) {
    const StepReport report = world.steps(1);
    all.handed_over += report.handed_over;
    all.missed += report.tolerance_missed;
    all.largest = std::max(all.largest, report.error_estimate);
  }
  return all;
}

Scene byEvents(Scene scene, double step, double tolerance) {
  scene.solver.method = Method::kRk;
  scene.solver.events = true;
  scene.solver.step = step;
  scene.solver.tolerance = tolerance;
  return scene;
}

/// A ball that slides into the line of fall: friction is all that takes short pieces.
TEST(EventsWithinATolerance, SlideAsNearAsItAsks) {
  for (const double step : {0.05, 1.0 / 120})
    for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9}) {
      World world(byEvents(AcrossSlope::scene(), step, tolerance));
      const Told all = told(world, static_cast<int>(std::lround(AcrossSlope::kTime / step)));
      EXPECT_LT((world.x(0) - AcrossSlope::end()).norm(), tolerance * AcrossSlope::kTime)
          << step << " " << tolerance;
      EXPECT_EQ(all.handed_over, 0);
      EXPECT_EQ(all.missed, 0);
      EXPECT_GT(all.largest, 0);
      EXPECT_LE(all.largest, tolerance);
    }
}

/// A ball that is dropped bounces off the floor several times within one step.
TEST(EventsWithinATolerance, BounceAsOftenAsTheyShould) {
  constexpr double kRadius = 0.1, kHeight = 0.01, kBounce = 0.8;
  Scene scene = sceneOf(oneParticle(2, kRadius), Vec3(0, 0, kRadius + kHeight));
  scene.gravity = Vec3(0, 0, -kG);
  scene.obstacles = {floorPlane(0.4, kBounce)};
  World world(byEvents(scene, 0.1, 1e-8));
  const Told all = told(world, 2);
  double speed = std::sqrt(2 * kG * kHeight), left = 0.2 - speed / kG;
  for (speed *= kBounce; left > 2 * speed / kG; speed *= kBounce) left -= 2 * speed / kG;
  EXPECT_NEAR(world.x(0).z() - kRadius, speed * left - 0.5 * kG * left * left, 1e-10);
  EXPECT_EQ(all.handed_over, 0);
  EXPECT_EQ(all.missed, 0);
}

/// A human from its first touch of the stairs on: pieces follow what is allowed. By the parts of
/// `shake` 43 of the 60 steps miss a millionth.
TEST(EventsWithinATolerance, KeepWhatAHumanMayErrThatFallsOntoStairs) {
  constexpr double kStep = 1.0 / 60;
  constexpr int kSteps = 30;
  const Scene stairs = loadScene("stairs");
  World before(byEvents(stairs, kStep, 0));
  before.steps(18);
  const auto run = [&](double step, double tolerance, Told& all) {
    World world(byEvents(stairs, step, tolerance));
    world.state = before.state;
    world.state.multipliers = startState(world.model).multipliers;
    all = told(world, static_cast<int>(std::lround(kSteps * kStep / step)));
    return world.state.x;
  };
  Told exact;
  const Points best = run(kStep / 16, 0, exact);
  EXPECT_EQ(exact.handed_over, 0);
  for (const double tolerance : {1e-5, 1e-6, 1e-7}) {
    Told kept;
    const double error = (run(kStep, tolerance, kept) - best).colwise().norm().maxCoeff();
    EXPECT_EQ(kept.missed, 0) << tolerance;
    EXPECT_LE(kept.largest, tolerance);
    EXPECT_LT(error, 3 * tolerance * kSteps * kStep);
    EXPECT_GT(error, 1e-5 * tolerance);
  }
}

/// Where pieces are as long as a step, more than one thing ends them, and beyond the first the
/// motion says little about which it is. Windows of 0.1 s in which a stick had left its edge 4e-5 s
/// after its end had, or a force ended after its place did (stairs: 4 to 12 um off and not told;
/// between_objects: 6 to 39 um).
TEST(EventsWithinATolerance, ComeInTheirOrder) {
  const auto expectKept = [](const char* name, double tolerance, const std::vector<int>& windows) {
    const Scene scene = loadScene(name);
    Scene leading = scene;
    leading.solver.method = Method::kShake;
    leading.solver.step = 1.0 / 960;
    World start(leading);
    for (const int window : windows) {
      start.steps(32 * window - static_cast<int>(start.state.step));
      const auto end = [&](double rate, double within) {
        World world(byEvents(scene, 1 / rate, within));
        world.state = start.state;
        world.state.step = 0;
        world.state.time = 0;
        world.state.multipliers = startState(world.model).multipliers;
        EXPECT_EQ(told(world, static_cast<int>(std::lround(0.1 * rate))).handed_over, 0) << window;
        return world.state.x;
      };
      const double error = (end(60, tolerance) - end(960, 0)).colwise().norm().maxCoeff();
      EXPECT_LT(error, 0.3 * tolerance) << name << " " << window;
    }
  };
  expectKept("stairs", 1e-5, {21, 22, 27, 28, 29, 31});
  expectKept("between_objects", 1e-6, {53, 54});
}

/// Hips that start at the tip of a wedge, which is left out of their region, slide off it along a
/// border, whose own curvature ends at the tip: a force of 14 krad/s^2 at the start, and then 18 cm
/// off and not told.
TEST(EventsWithinATolerance, SlideOffTheTipOfAWedge) {
  const Scene hung = parseScene(
      "ragdolls: [{model: human_thesis, position: [0, 0, 2.2], rpy_deg: [15, -40, 70],\n"
      "            velocity: [0.8, -0.6, 0.3], angular_velocity: [2, 1.5, -2.5]}]\n"
      "pins: [ragdoll/left_foot]\n"
      "solver: {damping: 0.4}\n");
  const auto end = [&](double step, double tolerance, Told& all) {
    World world(byEvents(hung, step, tolerance));
    all = told(world, static_cast<int>(std::lround(0.5 / step)));
    return world.state.x;
  };
  Told exact;
  const Points best = end(1.0 / 1000, 0, exact);
  EXPECT_EQ(exact.handed_over, 0);
  for (const double tolerance : {1e-4, 3e-5, 1e-5, 3e-6}) {
    Told kept;
    const double error = (end(0.1, tolerance, kept) - best).colwise().norm().maxCoeff();
    EXPECT_LT(error, 0.3 * tolerance) << tolerance;
    EXPECT_EQ(kept.missed, 0) << tolerance;
  }
}

/// What lies across a box is not for events: shake's parts keep to the tolerance, and it is told. A
/// rod slides along itself over two edges until friction has stopped it.
TEST(EventsWithinATolerance, TellWhatShakeTakes) {
  constexpr double kTolerance = 1e-3, kSpeed = 0.5, kRadius = 0.05, kFriction = 0.5;
  Scene scene = sceneOf(oneStick(1, 1, kRadius), Vec3(-0.5, 0, kRadius));
  scene.gravity = Vec3(0, 0, -kG);
  ObstacleSpec box = floorPlane(kFriction);
  box.type = ObstacleSpec::Type::kBox;
  box.size = Vec3(0.4, 1, 0.2);
  box.pose.position = Vec3(0, 0, -0.1);
  scene.obstacles = {box};
  scene.ragdolls[0].velocity = Vec3(kSpeed, 0, 0);
  World world(byEvents(scene, 1.0 / 60, kTolerance));
  int handed_over = 0;
  for (int i = 0; i < 30; ++i) handed_over += world.steps(1).handed_over;
  EXPECT_GE(handed_over, 6);  // as long as it slides
  const double way = kSpeed * kSpeed / (2 * kFriction * kG);
  EXPECT_NEAR(world.x(0).x(), way - 0.5, kTolerance);
  EXPECT_NEAR(world.x(1).z(), kRadius, 1e-9);
}

}  // namespace
}  // namespace ragdoll::test
