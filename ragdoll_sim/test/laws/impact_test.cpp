// Impacts against closed forms: a smooth ball and an elastic surface, without gravity or with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/build_model.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

constexpr double kElasticRadius = 0.1;

/// A ball that a surface without friction throws back as fast as it came.
struct ElasticBall {
  Model model;
  Inputs inputs;
  Workspace workspace;
  State state;

  ElasticBall(const Vec3& position, const Vec3& velocity, ObstacleSpec obstacle, double step,
              double gravity = 0, double tolerance = 0) {
    SkeletonSpec skeleton;
    skeleton.name = "ball";
    skeleton.particles.push_back(particle("p", Vec3::Zero(), 1, kElasticRadius));
    Scene scene = sceneOf(skeleton, position);
    scene.ragdolls[0].velocity = velocity;
    scene.gravity = Vec3(0, 0, -gravity);
    obstacle.friction = 0;
    obstacle.restitution = 1;
    scene.obstacles.push_back(obstacle);
    scene.solver.method = Method::kShake;
    scene.solver.step = step;
    scene.solver.tolerance = tolerance;
    model = buildModel(scene);
    inputs = startInputs(model);
    state = startState(model);
  }
  void run(double seconds) {
    const long steps = std::lround(seconds / model.solver.step);
    for (long i = 0; i < steps; ++i) step(model, inputs, workspace, state);
  }
};

/// Beside its middle a sphere of radius R turns the ball by its normal at first touch: the path and
/// the mirrored path meet at the centre distance R + r, whatever the step.
TEST(Impact, BesideTheMiddleOfASphereTurnsTheBallByTheNormalAtFirstTouch) {
  ObstacleSpec sphere;
  sphere.type = ObstacleSpec::Type::kSphere;
  sphere.radius = 0.3;
  const double x = 0.2, reach = sphere.radius + kElasticRadius, speed = 3;
  const double z = std::sqrt(reach * reach - x * x);  // of the ball at the touch
  const Vec3 normal(x / reach, 0, z / reach), in(0, 0, -speed);
  const Vec3 out = in - 2 * normal.dot(in) * normal;
  const double time = (1 - z) / speed;
  const Vec3 end = Vec3(x, 0, z) + (1 - time) * out;
  for (const double hz : {30, 60, 120, 240, 1000, 4000}) {
    ElasticBall ball(Vec3(x, 0, 1), in, sphere, 1 / hz);
    ball.run(1);
    EXPECT_NEAR((ball.state.x.col(0) - end).norm(), 0, 1e-6) << hz << " Hz";
  }
}

/// The same at a box's edge.
TEST(Impact, AtABoxsEdgeTurnsTheBallByTheNormalAtFirstTouch) {
  ObstacleSpec box;
  box.type = ObstacleSpec::Type::kBox;
  box.size = Vec3(1, 1, 1);
  box.pose.position = Vec3(-0.5, 0, -0.5);  // an edge along y through the origin
  const double x = 0.05, speed = 3, z = std::sqrt(kElasticRadius * kElasticRadius - x * x);
  const Vec3 normal(x / kElasticRadius, 0, z / kElasticRadius), in(0, 0, -speed);
  const Vec3 out = in - 2 * normal.dot(in) * normal;
  const Vec3 end = Vec3(x, 0, z) + (1 - (1 - z) / speed) * out;
  for (const double hz : {60, 120, 1000}) {
    ElasticBall ball(Vec3(x, 0, 1), in, box, 1 / hz);
    ball.run(1);
    EXPECT_NEAR((ball.state.x.col(0) - end).norm(), 0, 1e-5) << hz << " Hz";
  }
}

/// A step that ends just above the surface leaves the bounce to the next one.
TEST(Impact, AGapOfAWholeNumberOfStepsBounces) {
  for (const double hz : {30, 60, 120, 240, 1000}) {
    ElasticBall ball(Vec3(0, 0, 0.2), Vec3(0, 0, -1), floorPlane(), 1 / hz);
    ball.run(1);
    EXPECT_NEAR(ball.state.v(2, 0), 1, 1e-12) << hz << " Hz";
    EXPECT_NEAR(ball.state.x(2, 0), 1, 1e-6) << hz << " Hz";
  }
}

/// The same of slow ones, at a fixed step and within a tolerance: where a part ends at the touch,
/// one in two halves may be thrown back in it and the whole one not, which is no smooth motion to
/// extrapolate.
TEST(Impact, SlowOnesBounceWhereverAStepEnds) {
  for (const double tolerance : {0.0, 1e-2, 1e-3, 1e-4, 1e-5})
    for (const double speed : {0.5, 0.1, 0.05, 0.01})
      for (const double hz : {30, 60, 120})
        for (const double off : {-1e-7, -1e-9, 0.0, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5}) {
          const double gap = 6 * speed / hz + off;
          ElasticBall ball(Vec3(0, 0, kElasticRadius + gap), Vec3(0, 0, -speed), floorPlane(),
                           1 / hz, 0, tolerance);
          ball.run(10 / hz);
          const double up = kElasticRadius + 10 * speed / hz - gap;
          ASSERT_NEAR(ball.state.v(2, 0), speed, 1e-9 * speed)
              << tolerance << " " << hz << " Hz " << off << " m";
          EXPECT_NEAR(ball.state.x(2, 0), up, 1e-6)
              << tolerance << " " << speed << " m/s " << hz << " Hz " << off << " m";
        }
}

/// Along a wall gravity does not press: what falls past it and comes at 6 mm/s is thrown back.
TEST(Impact, OffAWallThatItFallsPastABallBounces) {
  constexpr double kGap = 1e-3, kSpeed = 6e-3;
  ObstacleSpec wall = floorPlane();
  wall.normal = -Vec3::UnitX();
  for (const double hz : {60, 250, 1000, 4000}) {
    ElasticBall ball(Vec3(-kElasticRadius - kGap, 0, 0), Vec3(kSpeed, 0.05, 0), wall, 1 / hz, 9.81);
    ball.run(1);
    EXPECT_NEAR(ball.state.x(0, 0), -kElasticRadius + kGap - kSpeed, 1e-9) << hz << " Hz";
  }
}

/// Slower than what bounces in a part as long as the step, but not in half of it: the halves may
/// end thrown back and the whole one at rest. What both tell together is no faster than either.
TEST(Impact, NoneLeavesFasterThanItCame) {
  for (const double tolerance : {1e-5, 1e-6, 1e-8})
    for (const double speed : {1.2e-3, 1e-3, 5e-4, 2e-4})
      for (const double hz : {30, 60, 120})
        for (const double off : {-1e-7, -1e-9, 0.0, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6}) {
          ElasticBall ball(Vec3(0, 0, kElasticRadius + 6 * speed / hz + off), Vec3(0, 0, -speed),
                           floorPlane(), 1 / hz, 0, tolerance);
          ball.run(10 / hz);
          EXPECT_LT(ball.state.v(2, 0), (1 + 1e-9) * speed)
              << tolerance << " " << speed << " m/s " << hz << " Hz " << off << " m";
        }
}

/// The same of a rod that lands flat: both ends bounce, however near above the surface a step ends.
TEST(Impact, ARodThatLandsFlatBouncesWithBothEnds) {
  for (const double gap : {1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5})
    for (const double hz : {60, 250, 1000, 4000}) {
      constexpr double kRadius = 0.03;
      SkeletonSpec rod = oneStick();
      for (ParticleSpec& p : rod.particles) p.radius = kRadius;
      Scene scene = weightless(rod, Vec3(0, 0, -1));
      scene.ragdolls[0].pose.position.z() = kRadius + 6 / hz + gap;
      scene.obstacles = {floorPlane(0, 0.5)};
      scene.solver.method = Method::kShake;
      scene.solver.step = 1 / hz;
      World world(scene);
      world.steps(8);
      for (int i = 0; i < 2; ++i)
        EXPECT_NEAR(world.state.v(2, i), 0.5, 1e-9) << gap << " m, " << hz << " Hz, " << i;
    }
}

/// Dropped from 5 cm it comes up to 5 cm after hundreds of bounces.
TEST(Impact, AnElasticBallBouncesOn) {
  ElasticBall ball(Vec3(0, 0, 0.15), Vec3::Zero(), floorPlane(), 1.0 / 120, 9.81);
  ball.run(60);
  double highest = 0;
  for (int i = 0; i < 120; ++i) {
    ball.run(1.0 / 120);
    highest = std::max(highest, ball.state.x(2, 0));
  }
  EXPECT_NEAR(highest, 0.15, 2e-3);
}

}  // namespace
}  // namespace ragdoll::test
