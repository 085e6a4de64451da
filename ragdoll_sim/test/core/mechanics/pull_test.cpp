#include "ragdoll_sim/core/pull.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// Share of the way that is left after a time on a critically damped spring, from rest.
double left(double time) { return (1 + kPullRate * time) * std::exp(-kPullRate * time); }

/// One step with the particle pulled to the target.
void pulledStep(World& world, int particle, const Vec3& target) {
  Poke poke;
  poke.start = world.state.time;
  poke.body = {0, {particle}, {1}};
  poke.force = pullForce(world.model, world.state, particle, target);
  world.inputs.pokes = {poke};
  world.steps(1);
}

Scene inSteps(SkeletonSpec skeleton, double step = 1.0 / 240) {
  Scene scene = weightless(std::move(skeleton));
  scene.solver.step = step;
  return scene;
}

TEST(Pull, AStickIsAsHeavyAsBothEndsAlongItAndAsOneAcross) {
  World world(inSteps(oneStick(2, 3)));
  Eigen::Matrix3d expected = Eigen::Matrix3d::Identity() / 2;
  expected(0, 0) = 1.0 / 5;
  EXPECT_LT((mobility(world.model, world.state, 0) - expected).norm(), 1e-12);
}

TEST(Pull, MobilityIsWhatAStepDoes) {
  SkeletonSpec chain;
  chain.particles = {particle("a", Vec3::Zero(), 2), particle("b", Vec3(0.3, 0, 0.4), 1),
                     particle("c", Vec3(0.7, 0.2, 0.1), 0.5)};
  chain.sticks = {stick("a", "b"), stick("b", "c")};
  const double h = 1e-4;
  for (int p = 0; p < 3; ++p) {
    World world(inSteps(chain, h));
    const Vec3 force(3, -2, 1);
    const Vec3 expected = h * mobility(world.model, world.state, p) * force;
    Poke poke;
    poke.body = {0, {p}, {1}};
    poke.force = force;
    world.inputs.pokes = {poke};
    world.steps(1);
    EXPECT_LT((world.v(p) - expected).norm(), 1e-6 * expected.norm());
  }
}

TEST(Pull, FollowsTheCriticallyDampedLawWhateverHangsOnIt) {
  for (const double mass : {0.01, 1.0, 100.0}) {
    World world(inSteps(oneStick(1, mass), 1e-4));
    const Vec3 start = world.x(0), way(0.2, 0.1, -0.3), target = start + way;
    while (world.state.time < 1) {
      pulledStep(world, 0, target);
      const double share = (target - world.x(0)).dot(way) / way.squaredNorm();
      ASSERT_NEAR(share, left(world.state.time), 1e-2) << mass << " kg, " << world.state.time;
    }
  }
}

TEST(Pull, NeverOvershootsAtAnyStep) {
  for (const double step : {1.0 / 1000, 1.0 / 60, 0.1, 0.5}) {
    World world(inSteps(oneParticle(3), step));
    double farthest = 0;
    while (world.state.time < std::max(3.0, 100 * step)) {
      pulledStep(world, 0, Vec3(0.4, 0, 0));
      farthest = std::max(farthest, world.x(0).x());
    }
    EXPECT_NEAR(world.x(0).x(), 0.4, 1e-6) << step;
    EXPECT_LT(farthest, 0.4 + (step < 0.02 ? 1e-9 : 0.1)) << step;
  }
}

TEST(Pull, GravityDrawsItOffByWhatTheSpringTakesToCarryTheBody) {
  Scene scene = inSteps(oneStick(1, 4));
  scene.gravity = Vec3(0, 0, -9.81);
  World world(scene);
  const Vec3 target(0, 0, 0.2);
  for (int i = 0; i < 240 * 60; ++i) pulledStep(world, 0, target);
  EXPECT_NEAR(world.x(0).z(), 0.2 - 9.81 / (kPullRate * kPullRate), 0.02);
}

TEST(Pull, FarTargetsPullNoHarderThanTheReach) {
  World world(inSteps(oneParticle(2)));
  const Vec3 far = pullForce(world.model, world.state, 0, Vec3(1e6, 0, 0));
  const Vec3 near = pullForce(world.model, world.state, 0, Vec3(kPullReach, 0, 0));
  EXPECT_NEAR(far.x(), near.x(), 1e-9);
  EXPECT_NEAR(near.x(), 2 * kPullRate * kPullRate * kPullReach, 0.15 * near.x());
}

TEST(Pull, APinnedParticleIsNotPulledAndPinsAroundItAreFelt) {
  Scene scene = inSteps(oneStick(1, 1));
  scene.pins = {{"ragdoll/a", "", ""}};
  World world(scene);
  EXPECT_EQ(pullForce(world.model, world.state, 0, Vec3(0, 0, 1)), Vec3::Zero().eval());
  const Eigen::Matrix3d A = mobility(world.model, world.state, 1);
  EXPECT_NEAR(A(0, 0), 0, 1e-12);  // along the stick it is held
  EXPECT_NEAR(A(1, 1), 1, 1e-12);
  EXPECT_TRUE(pullForce(world.model, world.state, 1, Vec3(5, 0, 0)).allFinite());
}

}  // namespace
}  // namespace ragdoll
