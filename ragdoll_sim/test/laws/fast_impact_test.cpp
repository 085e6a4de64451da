// Impacts by the fast method: what they leave does not depend on when in the step they fall, sticks
// are hit along the normal of the edge that hits them, and what they do to error.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "ragdoll_sim/core/solver_presets.h"
#include "support/falls.h"
#include "support/tolerance_run.h"

namespace ragdoll {
namespace {

using namespace test;

State stateAtEnd(Scene scene, Method method, double step, double seconds) {
  scene.solver.method = method;
  scene.solver.step = step;
  scene.solver.sleep = false;
  World world(scene);
  world.steps(static_cast<int>(std::lround(seconds / step)));
  return world.state;
}

Vec3 vectorOf(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double x = unit(random), y = unit(random);
  return Vec3(x, y, unit(random));
}

/// A triangle of balls that flies onto a plane, turned and thrown at random.
Scene thrownTriangle(std::mt19937& random) {
  Scene scene = parseScene(
      "gravity: [0, 0, 0]\n"
      "ragdolls: [{model: {name: triangle, particles: {"
      "a: {position: [0, 0, 0], mass: 1, radius: 0.05}, "
      "b: {position: [0.6, 0, 0], mass: 2, radius: 0.05}, "
      "c: {position: [0.2, 0.5, 0], mass: 1.5, radius: 0.05}}, "
      "sticks: [[a, b], [b, c], [a, c]]}, position: [0, 0, 1]}]\n"
      "obstacles: [{type: plane}]\n",
      "test");
  RagdollSpec& body = scene.ragdolls[0];
  const Vec3 turn = vectorOf(random);
  body.pose.orientation = Quat(1, turn.x(), turn.y(), turn.z()).normalized();
  body.velocity = 2 * vectorOf(random);
  body.velocity.z() = -3;
  body.angular_velocity = 3 * vectorOf(random);
  scene.obstacles[0].friction = 0.5 + 0.4 * vectorOf(random).x();
  return scene;
}

/// In ascending order, of 100 thrown triangles: how far `fast` is from `shake`, which finds the time
/// of an impact, in `of` a state.
std::vector<double> offOfTriangles(double step, double exact_step, double seconds,
                                   Points State::*of) {
  std::mt19937 random(3);
  std::vector<double> off;
  for (int k = 0; k < 100; ++k) {
    const Scene scene = thrownTriangle(random);
    const State exact = stateAtEnd(scene, Method::kShake, exact_step, seconds);
    off.push_back(largest(stateAtEnd(scene, Method::kFast, step, seconds).*of - exact.*of));
  }
  std::sort(off.begin(), off.end());
  return off;
}

// The cone of a part of an impact alone left 0.08 m/s in ten of a hundred.
TEST(FastImpact, RubsAlikeWheneverInTheStep) {
  const std::vector<double> off = offOfTriangles(1.0 / 1000, 1.0 / 8000, 0.38, &State::v);  // [m/s]
  EXPECT_LT(off[50], 0.012);
  EXPECT_LT(off[90], 0.025);
}

// Where an impact's time was known to a fourth of the step: 2.6 and 6.7 mm.
TEST(FastImpact, IsWhenItIs) {
  const std::vector<double> off = offOfTriangles(1.0 / 60, 1.0 / 3840, 0.4, &State::x);  // [m]
  EXPECT_LT(off[50], 0.0012);
  EXPECT_LT(off[90], 0.003);
}

/// A rod that comes down with one end just over a box's face, and dips beyond its edge.
Scene rodOverAnEdge(double dips) {
  Scene scene = parseScene(
      "gravity: [0, 0, 0]\n"
      "ragdolls: [{model: {name: rod, particles: {"
      "a: {position: [-0.01, 0, 0], mass: 1, radius: 0.025}, "
      "b: {position: [0.29, 0, 0], mass: 1, radius: 0.025}}, sticks: [[a, b]]}, "
      "velocity: [0, 0, -3]}]\n"
      "obstacles: [{type: box, position: [-0.5, 0, -0.5], size: [1, 1, 1], friction: 0}]\n",
      "test");
  scene.ragdolls[0].pose.position = Vec3(0, 0, 0.1);
  scene.ragdolls[0].pose.orientation = Quat(Eigen::AngleAxisd(dips, Vec3::UnitY()));
  return scene;
}

// Its ends over the face differ by less than 2 mm: it was hit along the face's normal.
TEST(FastImpact, OfARodOverAnEdgeIsAlongTheNormalThere) {
  for (const double dips : {0.02, 0.05, 0.1, 0.15}) {
    const Scene scene = rodOverAnEdge(dips);
    const State exact = stateAtEnd(scene, Method::kShake, 1.0 / 8000, 0.04);
    const State fast = stateAtEnd(scene, Method::kFast, 1.0 / 8000, 0.04);
    EXPECT_GT(std::abs(exact.v(0, 0)), 0.5 * dips);  // [m/s] hit aside
    EXPECT_LT(largest(fast.v - exact.v), 0.02) << dips;
  }
}

struct Errors {
  double fast = 0, thesis = 0;  ///< [m] sums over windows
};

/// What 0.1 s add, in falls that begin turned at random.
Errors errorsIn(const std::string& name) {
  std::mt19937 random(100);
  Errors sum;
  for (int start = 0; start < 4; ++start) {
    Scene scene = loadScene(name);
    scene.solver.sleep = false;
    const Vec3 turn = vectorOf(random);
    scene.ragdolls[0].pose.orientation = Quat(0.5, turn.x(), turn.y(), turn.z()).normalized();
    scene.ragdolls[0].angular_velocity = 2 * vectorOf(random);
    Scene fine = scene;
    fine.solver.method = Method::kShake;
    fine.solver.step = 1.0 / 960;
    World run(fine);
    for (int window = 0; window < 30; ++window) {
      const auto then = [&run](Scene other) {
        World world(other);
        world.state.x = run.state.x;
        world.state.v = run.state.v;
        world.steps(static_cast<int>(std::lround(0.1 / other.solver.step)));
        return world.state.x;
      };
      const auto by = [&](const char* of) {
        Scene other = scene;
        other.solver = preset(of);
        other.solver.sleep = false;
        other.solver.joint_damping = scene.solver.joint_damping;
        return then(other);
      };
      Scene finest = fine;
      finest.solver.step = 1.0 / 3840;
      const Points exact = then(finest);
      sum.fast += largest(by("fast") - exact);
      sum.thesis += largest(by("thesis") - exact);
      run.steps(64);
    }
  }
  return sum;
}

class FastWindows : public testing::TestWithParam<const char*> {};
TEST_P(FastWindows, ErrByHalfOfTheThesissAtMost) {
  const Errors errors = errorsIn(GetParam());
  EXPECT_LT(errors.fast, 0.5 * errors.thesis) << errors.fast / errors.thesis;
}
INSTANTIATE_TEST_SUITE_P(Scenes, FastWindows, testing::Values("fall", "stairs", "between_objects"));

}  // namespace
}  // namespace ragdoll
