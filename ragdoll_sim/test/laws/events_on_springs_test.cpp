// `method: rk` from event to event through contact that gives way: springs and dampers press from
// where they are met until they would pull. docs/equations.md#event-driven-rk.
#include <gtest/gtest.h>

#include <cmath>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/ends.h"
#include "support/gravity.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

constexpr double kFloorStiffness = 2000, kFloorDamping = 20;

/// Of a mass of 1 kg over a floor: the gap [m] and its rate.
struct GapAndRate {
  double gap = 0, rate = 0;
};

GapAndRate inTheAir(const GapAndRate& from, double t) {
  return {from.gap + from.rate * t - 0.5 * kG * t * t, from.rate - kG * t};
}

/// On spring and damper: a damped oscillator about the depth at rest.
GapAndRate onTheFloor(const GapAndRate& from, double t) {
  const double decay = 0.5 * kFloorDamping, w = std::sqrt(kFloorStiffness - decay * decay);
  const double rest = -kG / kFloorStiffness, a = from.gap - rest, b = (from.rate + decay * a) / w;
  const double c = std::cos(w * t), s = std::sin(w * t), e = std::exp(-decay * t);
  return {rest + e * (a * c + b * s), e * ((b * w - decay * a) * c - (a * w + decay * b) * s)};
}

/// [s] Until spring and damper would pull.
double timeOnTheFloor(const GapAndRate& from) {
  double lo = 0.5 * M_PI / std::sqrt(kFloorStiffness), hi = 2 * lo;
  const auto force = [&](double t) {
    const GapAndRate at = onTheFloor(from, t);
    return -kFloorStiffness * at.gap - kFloorDamping * at.rate;
  };
  for (int i = 0; i < 60; ++i) (force(0.5 * (lo + hi)) > 0 ? lo : hi) = 0.5 * (lo + hi);
  return lo;
}

Scene onSprings(const SkeletonSpec& skeleton, double height, double hz) {
  Scene scene = sceneOf(skeleton, Vec3(0, 0, height));
  scene.gravity = Vec3(0, 0, -kG);
  ObstacleSpec floor = floorPlane(0.5, 0);
  floor.contact = {kFloorStiffness, kFloorDamping};
  scene.obstacles.push_back(floor);
  scene.solver.method = Method::kRk;
  scene.solver.events = true;
  scene.solver.step = 1 / hz;
  return scene;
}

TEST(EventsOnSprings, ABallLandsAndLeavesByTheFormula) {
  const double radius = 0.1, gap = 0.05;
  const double lands = std::sqrt(2 * gap / kG);
  const GapAndRate landed = {0, -kG * lands};
  const double stays = timeOnTheFloor(landed);
  const GapAndRate left = onTheFloor(landed, stays);
  World world(onSprings(oneParticle(1, radius), radius + gap, 120));
  for (int n = 1; n < 25; ++n) {
    EXPECT_EQ(world.steps(1).handed_over, 0);
    const double t = n / 120.0;
    const GapAndRate exact = t < lands           ? inTheAir({gap, 0}, t)
                             : t < lands + stays ? onTheFloor(landed, t - lands)
                                                 : inTheAir(left, t - lands - stays);
    if (t > lands + stays && exact.gap < 0) break;
    ASSERT_NEAR(world.x(0).z() - radius, exact.gap, 1e-9) << n;
    ASSERT_NEAR(world.v(0).z(), exact.rate, 1e-7) << n;
  }
}

TEST(EventsOnSprings, ASoftHumanLandsAtFifthOrder) {
  const auto land = [](double hz) {
    Scene scene = parseScene(
        "ragdolls: [{name: soft, model: human, contact: compliant, position: [0, 0, 1.0]}]\n"
        "obstacles: [{type: plane, friction: 0.6}]\n"
        "solver: {method: rk, events: true}\n");
    scene.solver.step = 1 / hz;
    World world(scene);
    int handed_over = 0;
    for (int n = 0; n < std::lround(0.1 * hz); ++n) handed_over += world.steps(1).handed_over;
    EXPECT_EQ(handed_over, 0) << hz;
    return world.state.x;
  };
  const Points exact = land(1920);
  const double coarse = (land(120) - exact).cwiseAbs().maxCoeff();
  const double fine = (land(480) - exact).cwiseAbs().maxCoeff();
  EXPECT_LT(coarse, 1e-7);
  EXPECT_LT(fine, 1e-10);
}

/// Feet that land on a soft slope and stick, slide a little, or slide freely: shake meets rk, at its
/// order (it was 1.2, with 3.6e-4 m at 250 Hz).
TEST(EventsOnSprings, FeetOnASoftSlopeAreWhereShakeSaysToSecondOrder) {
  for (const double friction : {1.0, 0.1, 0.0}) {
    Scene scene = parseScene(
        "ragdolls: [{model: human, contact: compliant, position: [0, 0, 0.995]}]\n"
        "obstacles: [{type: plane, normal: [0.17, 0, 1], stiffness: 20000}]\nsolver: {sleep: false}\n");
    scene.obstacles[0].friction = friction;
    const auto after = [&](Method method, double hz) {
      scene.solver.method = method;
      scene.solver.events = method == Method::kRk;
      scene.solver.step = 1 / hz;
      World world(scene);
      world.steps(static_cast<int>(std::lround(0.1 * hz)));
      return world.state.x;
    };
    const Points exact = after(Method::kRk, 2000);
    EXPECT_LT((after(Method::kShake, 250) - exact).cwiseAbs().maxCoeff(), 1e-4) << friction;
    EXPECT_LT((after(Method::kShake, 1000) - exact).cwiseAbs().maxCoeff(), 6.5e-6) << friction;
    EXPECT_LT((after(Method::kShake, 4000) - exact).cwiseAbs().maxCoeff(), 4.5e-7) << friction;
  }
}

/// A stick whose ends meet a soft sphere: where the place is passes from the stick to its end and
/// back, and the guard sees what the springs hold, not what planes say.
TEST(EventsOnSprings, AStickLeavesASoftSphereWithItsEnergy) {
  for (const double hz : {240, 960}) {
    Scene scene = parseScene(
        "gravity: [0, 0, 0]\nragdolls:\n  - {contact: compliant, position: [-0.378, -0.095, 0.45], rpy_deg: [0, 30, -26.4],\n"
        "     velocity: [-0.015, 0.48, -2], angular_velocity: [2.8, 1.35, 0.25], model: {particles: {a: {position: [0, 0, 0],\n"
        "     radius: 0.05}, b: {position: [0.4, 0, 0], radius: 0.05}}, sticks: [[a, b]], segments: {ab: {from: a,\n"
        "     to: b, mass: 1, gyration: 0.289, contact: {stiffness: 20000}}}}}\n"
        "obstacles: [{type: sphere, position: [0, 0, -0.2], radius: 0.2, friction: 0, stiffness: 20000}]\n"
        "solver: {method: rk, events: true, sleep: false}\n");
    scene.solver.step = 1 / hz;
    World world(scene);
    const double before = kineticEnergy(world.model, world.state);
    for (int i = 0; i < 0.8 * hz; ++i) world.steps(1);
    EXPECT_GT(world.v(0).z() + world.v(1).z(), -2) << "it is met";
    EXPECT_NEAR(kineticEnergy(world.model, world.state) / before, 1, 1e-6) << hz;
  }
}

/// A rod sinks into a soft sphere until its shallower end touches, too. To shake that end was the
/// stick's as of rigid contact, and had no spring (4 cm apart at any step).
TEST(EventsOnSprings, ARodSinksInUpToItsEndByBothMethods) {
  const Scene scene = parseScene(
      "ragdolls: [{position: [-0.2, 0, 1.05], rpy_deg: [0, 4, 0], velocity: [0, 0, -3.5], model: "
      "{particles: {a: {position: [0, 0, 0], radius: 0.03}, b: {position: [0.5, 0, 0], radius: "
      "0.03}}, sticks: [[a, b]], segments: {ab: {from: a, to: b, mass: 3, gyration: 0.289}}}}]\n"
      "obstacles: [{type: sphere, position: [0, 0, 0.5], radius: 0.5, friction: 0.3, stiffness: "
      "3000, damping: 50}]\n");
  constexpr double kTime = 0.3;
  const Points best = endOfImpacts(scene, Method::kRk, 1.0 / 4000, kTime);
  EXPECT_LT(largest(endOfImpacts(scene, Method::kRk, 1.0 / 500, kTime) - best), 1e-10);
  EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1.0 / 1000, kTime) - best), 1e-4);
  EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1.0 / 8000, kTime) - best), 2e-6);
}

/// The hips' cones end in several rows at once, which depend on each other: those that do not press
/// seem to close. The search for that passed a knee's stop, which stayed open by 3e-3 rad.
TEST(EventsOnSprings, NoLimitIsPassedBesideOneThatOnlySeemsToClose) {
  Scene scene = parseScene(
      "ragdolls: [{name: b, model: human, position: [0, 0, 1], rpy_deg: [0, 6, 20],\n"
      "  velocity: [0.3, 0.1, 0], angular_velocity: [0, 0.3, 0.5]}]\n"
      "obstacles: [{type: plane, normal: [0.2, 0.1, 1], friction: 0, stiffness: 2.0e4, damping: 200}]\n"
      "solver: {method: rk, events: true, sleep: false, step: 0.002}\n");
  World world(scene);
  int handed_over = 0;
  for (int n = 0; n < 50; ++n) {
    handed_over += world.steps(1).handed_over;
    ASSERT_LT(maxLimitViolation(world.model, world.state), 1e-6) << n;  // shake's own
  }
  EXPECT_LE(handed_over, 2);
}

}  // namespace
}  // namespace ragdoll::test
