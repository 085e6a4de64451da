// A ball on a rod that swings against a wall, by `method: rk` from event to event: against its one
// angle, integrated apart from the product's code.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/event_steps.h"
#include "support/gravity.h"
#include "support/integrate.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

constexpr double kBobRadius = 0.05, kSwingStart = -1.1;  ///< [m], [rad] from hanging

using Swing = Eigen::Vector2d;  ///< angle from hanging [rad], and its rate; the rod is 1 m long

Swing swungFor(const Swing& start, double time) {
  return integrate([](const Swing& s) { return Swing(s[1], -kG * std::sin(s[0])); }, start, time);
}

/// [s] Until the angle first passes `stop`, from below; at most `most`.
double timeToAngle(const Swing& start, double stop, double most) {
  const int looks = 20;
  double lo = 0, hi = most;
  Swing s = start;
  for (int i = 1; i <= looks; ++i) {
    s = swungFor(s, most / looks);
    if (s[0] > stop && s[1] > 0) {
      lo = most * (i - 1) / looks;
      hi = most * i / looks;
      break;
    }
    if (i == looks) return most;
  }
  const Swing near = swungFor(start, lo);
  double time = 0;
  for (int i = 0; i < 8; ++i) {
    const Swing at = swungFor(near, time);
    time = std::clamp(time + (stop - at[0]) / at[1], 0.0, hi - lo);
  }
  return lo + time;
}

/// [rad] Where it is after `time` with a wall that it touches at `stop`.
double angleAgainst(double stop, double restitution, double time) {
  Swing s(kSwingStart, 0);
  for (;;) {
    const double hit = timeToAngle(s, stop, time);
    s = swungFor(s, hit);
    time -= hit;
    if (!(time > 0)) return s[0];
    if (restitution == 0 && stop < 0) return stop;  // gravity presses it on the wall
    s = Swing(stop, -restitution * s[1]);
  }
}

Scene pendulum(double stop, double restitution) {
  Scene scene = sceneOf(oneStick(1, 2, kBobRadius));
  scene.gravity = Vec3(0, 0, -kG);
  scene.ragdolls[0].pose.orientation =
      Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2 - kSwingStart, Vec3::UnitY()));
  scene.pins.push_back(pinOf("ragdoll/a"));
  ObstacleSpec wall = floorPlane(0, restitution);
  wall.normal = -Vec3::UnitX();
  wall.pose.position = Vec3(std::sin(stop) + kBobRadius, 0, 0);
  scene.obstacles.push_back(wall);
  scene.solver.method = Method::kRk;
  scene.solver.events = true;
  scene.solver.step = kStep;
  scene.solver.sleep = false;
  return scene;
}

/// For two seconds, with no step handed over.
void expectAgainst(double stop, double restitution) {
  World world(pendulum(stop, restitution));
  int handed_over = 0;
  for (int n = 1; n <= 240; ++n) {
    handed_over += world.steps(1).handed_over;
    if (n % 40 != 0) continue;
    const double angle = angleAgainst(stop, restitution, n * kStep);
    EXPECT_LT((world.x(1) - Vec3(std::sin(angle), 0, -std::cos(angle))).norm(), kNear)
        << stop << " " << restitution << ", step " << n;
  }
  EXPECT_EQ(handed_over, 0);
}

TEST(Events, APendulumIsThrownBackByAWall) {
  expectAgainst(0.3, 0.9);
  expectAgainst(0.3, 0.5);
}

TEST(Events, APendulumThatIsNotThrownBackLeavesOnlyByItsWeight) {
  expectAgainst(0.3, 0);
  expectAgainst(-0.3, 0);
}

}  // namespace
}  // namespace ragdoll::test
