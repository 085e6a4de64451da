// Bodies in free motion follow the integrators' closed forms; momentum is conserved.
#include <gtest/gtest.h>

#include "core/step/workspace.h"
#include "ragdoll_sim/core/measures.h"
#include "support/gravity.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kH = 1.0 / 60;

/// Fall of the centre of mass from rest in n steps, in units of g h^2.
struct FreeFall {
  Integrator integrator;
  double (*steps)(double n);
};

class Ballistic : public testing::TestWithParam<FreeFall> {};

TEST_P(Ballistic, CentreOfMassFollowsTheClosedForm) {
  SkeletonSpec body = oneStick(1, 3);
  body.particles.push_back(particle("c", Vec3(0.3, 0.4, 0.5), 2));
  body.sticks.push_back(stick("b", "c"));
  Scene scene = sceneOf(body, Vec3(0, 0, 5));
  scene.ragdolls[0].velocity = Vec3(1, -2, 3);
  scene.ragdolls[0].angular_velocity = Vec3(2, 1, -1);  // sticks pull: the centre must not notice
  scene.solver.integrator = GetParam().integrator;
  World world(scene);
  const Vec3 start = centreOfMass(world.model, world.state, 0);
  for (const int n : {1, 2, 60}) {
    World w(scene);
    w.steps(n);
    Vec3 expected = start + n * kH * Vec3(1, -2, 3);
    expected.z() -= kG * kH * kH * GetParam().steps(n);
    EXPECT_LT((centreOfMass(w.model, w.state, 0) - expected).norm(), 1e-12) << n << " steps";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Integrators, Ballistic,
    testing::Values(FreeFall{Integrator::kVerlet, [](double n) { return n * (n + 1) / 2; }},
                    FreeFall{Integrator::kSymplecticEuler,
                             [](double n) { return n * (n + 1) / 2; }},
                    FreeFall{Integrator::kEuler, [](double n) { return n * (n - 1) / 2; }},
                    FreeFall{Integrator::kMidpoint, [](double n) { return n * n / 2; }},
                    FreeFall{Integrator::kVelocityVerlet, [](double n) { return n * n / 2; }}));

TEST(Weightless, PokeGivesItsImpulseAndNothingElseChangesMomentum) {
  Scene scene = sceneOf(oneStick(1, 3));
  scene.gravity.setZero();
  scene.ragdolls[0].angular_velocity = Vec3(0, 0, 4);
  PokeSpec poke;
  poke.at = 0.1;
  poke.body = "b";
  poke.force = Vec3(10, 20, -30);
  poke.duration = 0.2;
  scene.pokes = {poke};
  World world(scene);
  world.steps(5);
  EXPECT_LT(momentum(world.model, world.state).norm(), 1e-13);
  world.steps(115);
  // 0.2 s at 60 Hz are 12 whole steps.
  EXPECT_LT((momentum(world.model, world.state) - 0.2 * poke.force).norm(), 1e-12);
}

TEST(Pin, HoldsItsParticleToTheBitAndTheRestHangsBelow) {
  Scene scene = sceneOf(oneStick(1, 2), Vec3(0.1, 0.2, 0.3));
  scene.pins = {pinOf("ragdoll/a")};
  scene.solver.damping = 2;
  scene.solver.sweeps = 50;
  World world(scene);
  const Vec3 start = world.x(0);
  world.steps(1200);
  EXPECT_EQ(world.x(0), start);
  EXPECT_EQ(world.v(0), Vec3::Zero());
  EXPECT_LT((world.x(1) - (start - Vec3::UnitZ())).norm(), 1e-3);
}

TEST(Relaxation, BringsSticksToTheirLength) {
  // A triangle put far from where its sticks want it, weightless.
  SkeletonSpec body = oneStick();
  body.particles.push_back(particle("c", Vec3(0.5, 0.8, 0), 2));
  body.sticks.push_back(stick("b", "c"));
  body.sticks.push_back(stick("c", "a"));
  Scene scene = sceneOf(body);
  scene.gravity.setZero();
  scene.ragdolls[0].place = {{"c", Vec3(0.9, 2, 0.4)}};
  scene.solver.sweeps = 200;
  World world(scene);
  world.workspace.setGuard(false);  // else the guard draws it in slowly
  world.steps(1);
  EXPECT_LT(maxStickError(world.model, world.state), 1e-12);
}

TEST(Relaxation, CoincidentParticlesPart) {
  Scene scene = sceneOf(oneStick());
  scene.gravity.setZero();
  scene.ragdolls[0].place = {{"b", Vec3::Zero()}};
  World world(scene);
  world.workspace.setGuard(false);
  world.steps(1);
  EXPECT_NEAR((world.x(1) - world.x(0)).norm(), 1, 1e-9);
}

TEST(Determinism, TwoRunsGiveTheSameBits) {
  Scene scene = sceneOf(oneStick(1, 2, 0.1), Vec3(0, 0, 1));
  scene.ragdolls[0].angular_velocity = Vec3(1, 5, 2);
  scene.obstacles = {floorPlane(0.5, 0.3)};
  World a(scene), b(scene);
  a.steps(300);
  b.steps(300);
  EXPECT_EQ(hash(a.state), hash(b.state));
  b.state.v(0, 0) += 1e-16 + 1e-12;
  EXPECT_NE(hash(a.state), hash(b.state));
}

}  // namespace
}  // namespace ragdoll
