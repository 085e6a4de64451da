// Second order through contact: where the slip turns, where the normal turns, over edges, where
// bodies meet between two steps, and where joints are damped beside an impact or while something
// slides.
#include <gtest/gtest.h>

#include <cmath>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/across_slope.h"
#include "support/ends.h"
#include "support/gravity.h"
#include "support/integrate.h"
#include "support/limbs.h"

namespace ragdoll::test {
namespace {

/// Of bodies that never sleep.
Points endAwake(Scene scene, Method method, double rate, double seconds) {
  scene.solver.sleep = false;
  return endOf(scene, method, rate, seconds);
}

/// shake and rk end within `near` [m] of `exact` at 240 Hz, and sixteen times nearer at four times
/// that: second order, or what is left of it by rounding to where contacts begin and end.
void expectSecondOrder(const Scene& scene, double seconds, const Points& exact, double near) {
  for (const Method method : {Method::kShake, Method::kRk}) {
    const double coarse = (endAwake(scene, method, 240, seconds) - exact).norm();
    const double fine = (endAwake(scene, method, 960, seconds) - exact).norm();
    EXPECT_LT(coarse, near);
    EXPECT_LT(fine, near / 10) << "of order " << std::log2(coarse / fine) / 2;
  }
}

TEST(ContactOrder, OfASlipThatTurns) {
  expectSecondOrder(AcrossSlope::scene(), AcrossSlope::kTime, AcrossSlope::end(), 5e-6);
}

/// A ball that slides up a slope, to rest, and down again: friction jumps to its other side.
/// 1.7e-4 m off at 250 Hz and 2.7e-6 m at 16000 Hz where the motion goes on over that.
TEST(ContactOrder, OfASlipThatTurnsBack) {
  const double slope = 3, weight = 9, friction = 0.2, speed = 0.4, time = 0.3;
  Scene scene = sceneOf(oneParticle(1, 0.05), Vec3(0, 0, 0.05));
  scene.gravity = Vec3(slope, 0, -weight);
  scene.ragdolls[0].velocity = Vec3(-speed, 0, 0);
  scene.obstacles = {floorPlane(friction)};
  const double up = speed / (slope + friction * weight);
  const double down = (slope - friction * weight) / 2 * (time - up) * (time - up);
  const Vec3 exact(down - speed * up / 2, 0, 0.05);
  for (const double rate : {250, 500, 1000, 4000})
    EXPECT_LT((endAwake(scene, Method::kShake, rate, time) - exact).norm(), 1e-12) << rate;
  // All but back: 1.8e-4 m off at 250 and 500 Hz, 8e-5 m at 1000 Hz where nothing is cut.
  scene.ragdolls[0].velocity = Vec3(-speed, 0.01, 0);
  Scene events = scene;
  events.solver.events = true;
  const Points end = endAwake(events, Method::kRk, 1000, time);
  for (const double rate : {250, 500, 1000})
    EXPECT_LT((endAwake(scene, Method::kShake, rate, time) - end).norm(), 0.012 / rate) << rate;
}

/// Down a sphere, straight: by an integration of the angle.
TEST(ContactOrder, OfANormalThatTurns) {
  const double radius = 0.5, ball = 0.05, friction = 0.1, speed = 0.3, time = 0.3;
  Scene scene = sceneOf(oneParticle(1, ball), Vec3(0, 0, radius + ball));
  scene.gravity = Vec3(0, 0, -kG);
  scene.ragdolls[0].velocity = Vec3(speed, 0, 0);
  ObstacleSpec sphere;
  sphere.type = ObstacleSpec::Type::kSphere;
  sphere.radius = radius;
  sphere.friction = friction;
  scene.obstacles = {sphere};
  const double l = radius + ball;
  const auto rate = [&](const Eigen::Vector2d& s) {  // angle from the top, and its rate
    const double presses = kG * std::cos(s[0]) - l * s[1] * s[1];
    return Eigen::Vector2d(s[1], (kG * std::sin(s[0]) - friction * presses) / l);
  };
  const Eigen::Vector2d state = integrate(rate, Eigen::Vector2d(0, speed / l), time);
  expectSecondOrder(scene, time, l * Vec3(std::sin(state[0]), 0, std::cos(state[0])), 5e-6);
}

/// Without friction over an edge with a rounding of the ball's radius alone, or off the end of a
/// capsule; so fast that it leaves there.
class OverAnEdge : public testing::TestWithParam<ObstacleSpec::Type> {};

TEST_P(OverAnEdge, WhatIsFastEnoughLeaves) {
  const double ball = 0.05, speed = 1.5, way = 0.2013, time = 0.2;
  Scene scene = sceneOf(oneParticle(2, ball), Vec3(-way, 0, ball));
  scene.gravity = Vec3(0, 0, -kG);
  scene.ragdolls[0].velocity = Vec3(speed, 0, 0);
  ObstacleSpec obstacle;
  obstacle.type = GetParam();
  obstacle.friction = 0;
  if (obstacle.type == ObstacleSpec::Type::kBox) {
    obstacle.size = Vec3(1, 1, 0.5);
    obstacle.pose.position = Vec3(-0.5, 0, -0.25);
  } else {
    obstacle.radius = 0.1;
    obstacle.from = Vec3(-1, 0, -obstacle.radius);
    obstacle.to = Vec3(0, 0, -obstacle.radius);
  }
  scene.obstacles = {obstacle};
  const double falls = time - way / speed;
  const Vec3 exact(-way + speed * time, 0, ball - kG * falls * falls / 2);
  for (const Method method : {Method::kShake, Method::kRk})
    for (const double rate : {250, 500, 1000, 4000})  // 1e-3 m off where none is looked for
      EXPECT_LT((endAwake(scene, method, rate, time) - exact).norm(), 1e-11) << rate;
}

INSTANTIATE_TEST_SUITE_P(ContactOrder, OverAnEdge,
                         testing::Values(ObstacleSpec::Type::kBox, ObstacleSpec::Type::kCapsule));

/// A rod that lies on a box along an edge, beyond a corner, and slides off over all of that edge at
/// once, one end 2e-8 m ahead: 1.5e-4 m off at 1000 Hz and 7e-6 m at 16000 Hz where it lies flat on
/// beyond the corner.
TEST(ContactOrder, OfARodThatSlidesOffAlongAnEdge) {
  const Scene scene = parseScene(
      "gravity: [1, 0.5, -9.5]\n"
      "ragdolls: [{name: b, position: [-0.05, 0.3, 0.1], velocity: [0.9, 1.2, 0], model: {"
      "particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.05}, "
      "q: {position: [-0.4, -2e-8, 0], mass: 2, radius: 0.05}}, sticks: [[p, q]]}}]\n"
      "obstacles: [{type: box, position: [-0.5, 0, -0.2], size: [1, 1, 0.5], friction: 0.3}]\n");
  const Points end = endAwake(scene, Method::kShake, 16000, 0.24);
  for (const double rate : {1000, 4000})
    EXPECT_LT((endAwake(scene, Method::kShake, rate, 0.24) - end).norm(), 2 / (rate * rate))
        << rate;
  Scene exact = scene;
  exact.solver.events = true;
  EXPECT_LT((endAwake(exact, Method::kRk, 250, 0.24) - end).norm(), 3e-8);
}

/// With friction, three feet that carry each other and turn: 5.6e-6 m off at 16000 Hz where none is
/// looked for, of first order.
TEST(ContactOrder, OfAPlateThatSlidesOverAnEdge) {
  const Scene scene = parseScene(
      "ragdolls: [{name: b, position: [-0.06, 0.05, 0.05], velocity: [1.1, 0.9, 0], "
      "angular_velocity: [0, 0, 3], model: {particles: {p: {position: [0, 0, 0], radius: 0.05}, "
      "q: {position: [0.3, 0.05, 0], radius: 0.05}, r: {position: [0.1, 0.25, 0], radius: 0.05}}, "
      "segments: {s: {mass: 4, com: [0.13, 0.1, 0.02], inertia: [0.05, 0.06, 0.09, 0, 0, 0], "
      "particles: [p, q, r]}}}}]\n"
      "obstacles: [{type: box, position: [-0.1, 0, -0.25], size: [1, 0.9, 0.5], friction: 0.2}]\n");
  Scene exact = scene;
  exact.solver.events = true;
  const Points end = endAwake(exact, Method::kRk, 1000, 0.24);
  for (const double rate : {250, 1000, 4000, 16000})
    EXPECT_LT((endAwake(scene, Method::kShake, rate, 0.24) - end).norm(), 1 / (rate * rate))
        << rate;
}

/// A rod that turns on a capsule: the place that touches moves along it, and slips as it does half
/// way.
TEST(ContactOrder, OfAPlaceThatMovesAlongAStick) {
  SkeletonSpec rod = oneStick(1, 1, 0.05);
  Scene scene = sceneOf(rod, Vec3(-0.48, 0, 0.2));
  scene.gravity = Vec3(0, 0, -kG);
  scene.ragdolls[0].velocity = Vec3(0.2, 0.1, 0);
  scene.ragdolls[0].angular_velocity = Vec3(0, 0, 0.5);
  ObstacleSpec bar;
  bar.type = ObstacleSpec::Type::kCapsule;
  bar.from = Vec3(0, -1, 0);
  bar.to = Vec3(0, 1, 0);
  bar.radius = 0.15;
  bar.friction = 0.3;
  scene.obstacles = {bar};
  expectSecondOrder(scene, 0.05, endAwake(scene, Method::kShake, 15360, 0.05), 1.5e-6);
}

/// A rod that rolls over a sphere, its ends at 8 m/s: against rk from event to event. What it turns
/// in a step leaves the contact open after one solution. It is to be closed all the same, or it
/// does not count as touching, and velocities lack half a step of its force.
struct RollingRod {
  static constexpr double kTime = 0.04;

  static Scene scene() {
    Scene scene = sceneOf(oneStick(1, 1, 0.05), Vec3(-0.5, 0, 0.25));
    scene.gravity = Vec3(0, 0, -kG);
    scene.ragdolls[0].velocity = Vec3(0, 0.3, 0);
    scene.ragdolls[0].angular_velocity = Vec3(0, 16, 0);
    ObstacleSpec sphere;
    sphere.type = ObstacleSpec::Type::kSphere;
    sphere.radius = 0.2;
    sphere.friction = 0.5;
    scene.obstacles = {sphere};
    scene.solver.sleep = false;
    return scene;
  }
  static State end(Method method, double rate) {
    return stateOfImpacts(RollingRod::scene(), method, 1 / rate, kTime);
  }
};

TEST(ContactOrder, OfARodThatRollsFast) {
  const State exact = RollingRod::end(Method::kRk, 1000);
  for (const double rate : {250.0, 500.0, 1000.0, 2000.0}) {  // 32 mm a step, of a radius of 50 mm
    const State end = RollingRod::end(Method::kShake, rate);
    EXPECT_LT((end.x - exact.x).norm() * rate * rate, 30) << rate;   // [m/s^2]
    EXPECT_LT((end.v - exact.v).norm() * rate * rate, 900) << rate;  // [m/s^3]
  }
}

/// Two balls without weight, one at rest, that meet off their middles: at the same time and so by
/// the same normal whatever the step.
TEST(ContactOrder, OfBodiesThatMeetBetweenTwoSteps) {
  Scene scene = sceneOf(oneParticle(1, 0.1));
  scene.gravity.setZero();
  scene.ragdoll_collision = true;
  scene.ragdolls[0].velocity = Vec3(1, 0, 0);
  Scene other = sceneOf(oneParticle(2, 0.1), Vec3(0.5, 0.05, 0));
  other.ragdolls[0].name = "other";
  scene.ragdolls.push_back(other.ragdolls[0]);
  const Points exact = endAwake(scene, Method::kShake, 1000, 0.5);
  for (const double rate : {110.0, 130.0, 250.0})
    EXPECT_LT((endAwake(scene, Method::kShake, rate, 0.5) - exact).norm(), 1e-9) << rate;
}

/// A chain that lands: what it hits ends its damped motion where it is hit, not at the step's end.
TEST(ContactOrder, OfJointDampingBesideImpacts) {
  SkeletonSpec chain;
  for (const char* name : {"a", "b", "c"}) {
    ParticleSpec p;
    p.name = name;
    p.mass = 1;
    p.radius = 0.05;
    p.position = Vec3(0.4 * (name[0] - 'a'), 0.05 * (name[0] == 'c'), 0.1 * (name[0] == 'c'));
    chain.particles.push_back(p);
  }
  chain.sticks = {stick("a", "b"), stick("b", "c")};
  Scene scene = sceneOf(chain, Vec3(0, 0, 0.4));
  scene.gravity = Vec3(0, 0, -kG);
  scene.ragdolls[0].velocity = Vec3(1, 1, 0);
  scene.ragdolls[0].angular_velocity = Vec3(0, 1, 1);
  scene.obstacles = {floorPlane(0.3)};
  scene.solver.joint_damping = 2;
  expectSecondOrder(scene, 0.4, endAwake(scene, Method::kShake, 15360, 0.4), 1e-5);
}

/// Two rods as an arch, whose feet slide apart while the top falls and joints are damped.
struct Arch {
  static constexpr double kLength = 0.5, kFriction = 0.3, kDamping = 2, kRadius = 0.05;

  /// Of the angle of the rods to the floor and its rate: the push along a rod, from the top's and a
  /// foot's equations, masses of 1 kg. The damping is of what differs from the common motion.
  static Eigen::Vector2d rate(const Eigen::Vector2d& s) {
    const double l = kLength, c = std::cos(s[0]), n = std::sin(s[0]), w = s[1];
    const double falls = l * c * w;
    Eigen::Matrix2d A;
    A << l * c, -2 * n, l * n, c - kFriction * n;
    const Eigen::Vector2d b(
        l * n * w * w - kG - kDamping * 2 / 3 * falls,
        kFriction * (kG - kDamping * falls / 3) - kDamping * l * n * w - l * c * w * w);
    return {w, (A.inverse() * b)[0]};
  }

  /// [m] Height of the top after `time` from an angle and a rate on, by a method.
  static double top(double angle, double rate, Method method, double steps, double time) {
    const Vec3 foot(kLength * std::cos(angle), 0, 0), head(0, 0, kLength * std::sin(angle));
    SkeletonSpec arch;
    arch.particles = {particle("a", -foot, 1, kRadius), particle("b", head, 1, kRadius),
                      particle("c", foot, 1, kRadius)};
    arch.sticks = {stick("a", "b"), stick("b", "c")};
    Scene scene = sceneOf(arch, Vec3(0, 0, kRadius));
    scene.gravity = Vec3(0, 0, -kG);
    scene.obstacles = {floorPlane(kFriction)};
    scene.solver.method = method;
    scene.solver.joint_damping = kDamping;
    scene.solver.sleep = false;
    scene.solver.step = 1 / steps;
    World world(scene);
    world.state.v.col(0) = rate * Vec3(head.z(), 0, 0);
    world.state.v.col(1) = rate * Vec3(0, 0, foot.x());
    world.state.v.col(2) = -world.state.v.col(0);
    world.steps(static_cast<int>(std::lround(time * steps)));
    return world.x(1).z() - kRadius;
  }
};

TEST(ContactOrder, OfJointDampingOfWhatSlides) {
  const double angle = 0.9, rate = -1, time = 0.1;
  const Eigen::Vector2d end = integrate(Arch::rate, Eigen::Vector2d(angle, rate), time);
  for (const Method method : {Method::kShake, Method::kRk}) {
    const auto off = [&](double steps) {
      return std::abs(Arch::top(angle, rate, method, steps, time) -
                      Arch::kLength * std::sin(end[0]));
    };
    EXPECT_LT(off(480), 1e-6);
    EXPECT_LT(off(1920), off(480) / 15.5);
  }
}

}  // namespace
}  // namespace ragdoll::test
