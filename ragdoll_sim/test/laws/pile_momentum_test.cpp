// Bodies that touch each other without anything else keep their angular momentum, friction or not.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// Three humans without weight that are thrown at each other, one of them spinning.
Scene threeThatMeet(unsigned seed, const std::string& model = "human") {
  std::mt19937 random(seed);
  const auto any = [&](double most) {
    return most * (2.0 * static_cast<double>(random()) / 4294967295.0 - 1);
  };
  const auto turn = [&] {
    char text[100];
    std::snprintf(text, sizeof text, "rpy_deg: [%g, %g, %g]", any(180), any(90), any(180));
    return std::string(text);
  };
  Scene scene = parseScene(
      "gravity: [0, 0, 0]\nself_collision: true\nragdoll_collision: true\nragdolls:\n"
      "  - {name: a, model: " +
      model + ", " + turn() +
      ", angular_velocity: [2, 1, -1]}\n"
      "  - {name: b, model: " +
      model + ", position: [1.5, 0, 0.2], " + turn() +
      ", velocity: [-2, 0, 0]}\n"
      "  - {name: c, model: " +
      model + ", position: [0, 0.2, 1.5], " + turn() + ", velocity: [0, 0, -2]}\n");
  scene.solver.sleep = false;
  return scene;
}

TEST(WeightlessPile, KeepsItsAngularMomentum) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    World world(threeThatMeet(seed));
    const Vec3 start = angularMomentum(world.model, world.state);
    const double energy = kineticEnergy(world.model, world.state);
    for (int i = 0; i < 240; ++i) world.steps(1);
    EXPECT_LT(kineticEnergy(world.model, world.state), 0.9 * energy) << seed;  // they have met
    EXPECT_LT((angularMomentum(world.model, world.state) - start).norm(), 1e-10 * start.norm())
        << seed;
  }
}

/// Relative: what two seconds change of it.
double lostOf(Scene scene, Method method, double step, double tolerance, bool events = false) {
  scene.solver.method = method;
  scene.solver.step = step;
  scene.solver.tolerance = tolerance;
  scene.solver.events = events;
  World world(scene);
  const Vec3 start = angularMomentum(world.model, world.state);
  const double energy = kineticEnergy(world.model, world.state);
  world.steps(static_cast<int>(std::lround(2 / step)));
  EXPECT_LT(kineticEnergy(world.model, world.state), 0.9 * energy);  // they have met
  return (angularMomentum(world.model, world.state) - start).norm() / start.norm();
}

/// Formulas of any order err in the air: at 60 Hz by up to 1.5e-9, within a tolerance by rk from
/// event to event 1.6e-8, by shake 1.7e-10.
TEST(WeightlessPile, KeepsItsAngularMomentumByRungeKutta) {
  for (unsigned seed = 0; seed < 12; ++seed)
    for (const double step : {1.0 / 120, 1.0 / 60})
      EXPECT_LT(lostOf(threeThatMeet(seed), Method::kRk, step, 0), 1e-12) << seed << ", " << step;
}

TEST(WeightlessPile, KeepsItsAngularMomentumWithinATolerance) {
  for (unsigned seed = 0; seed < 6; ++seed)
    for (const Method method : {Method::kShake, Method::kRk})
      EXPECT_LT(lostOf(threeThatMeet(seed), method, 1.0 / 120, 1e-3), 1e-11)
          << seed << ", " << static_cast<int>(method);
  EXPECT_LT(lostOf(threeThatMeet(0), Method::kRk, 1.0 / 60, 1e-3, true), 1e-12);
}

/// Of three bodies of one model, with these columns of their particles.
Vec3 meanOf(const Model& model, State state, const Points& columns) {
  state.x = columns;
  Vec3 sum = Vec3::Zero();
  for (int r = 0; r < 3; ++r) sum += centreOfMass(model, state, r);
  return sum / 3;
}

/// What is hit at a motion's start takes no time. It took a millionth of the step, in which the
/// bodies stood still: the centre was up to 1e-7 m off after a second.
TEST(WeightlessPile, ItsCentreOfMassMovesEvenly) {
  for (const char* model : {"human_lumped", "human"})
    for (const double step : {1.0 / 30, 1.0 / 60})
      for (unsigned seed = 0; seed < 7; ++seed) {
        Scene scene = threeThatMeet(seed, model);
        scene.solver.step = step;
        World world(scene);
        const auto centre = [&] { return meanOf(world.model, world.state, world.state.x); };
        const Vec3 start = centre(), speed = meanOf(world.model, world.state, world.state.v);
        world.steps(static_cast<int>(std::lround(1 / step)));
        EXPECT_LT((centre() - start - speed).norm(), 1e-12)
            << model << ", " << step << ", " << seed;
      }
}

/// What shake leaves of a gap, where it takes a motion, is closed by moving bodies by up to 1e-6 m.
TEST(WeightlessPile, KeepsItsAngularMomentumFromEventToEvent) {
  EXPECT_LT(lostOf(threeThatMeet(0), Method::kRk, 1.0 / 120, 0, true), 1e-12);
}

}  // namespace
}  // namespace ragdoll
