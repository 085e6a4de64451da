// Bodies that touch each other, and limbs that touch limbs, by the fast method: the limit that rk
// has, momenta, and heaps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "support/falls.h"

namespace ragdoll {
namespace {

using namespace test;

/// Two bones across each other, off their middles, without weight or onto a floor; tapered.
Scene crossingBones(bool floor) {
  const auto bone = [floor](const char* name, double radius, const char* place) {
    char text[400];
    std::snprintf(text, sizeof text,
                  "  - {name: %s, model: {sticks: [[p, q]], particles: {p: {position: [-0.4, 0, "
                  "0], mass: 1, radius: %g}, q: {position: [0.4, 0, 0], mass: 1.5, radius: %g}}}, "
                  "%s}\n",
                  name, radius, floor ? radius : 1.3 * radius, place);
    return std::string(text);
  };
  const std::string world =
      floor ? "obstacles: [{type: plane, friction: 0.4}]\n" : "gravity: [0, 0, 0]\n";
  return parseScene(world + "ragdoll_collision: true\nragdolls:\n" +
                    bone("a", 0.03,
                         floor ? "position: [0, 0, 0.2], velocity: [0.3, 0, -1]"
                               : "position: [0.1, 0, 0.3], velocity: [0.3, 0, -1]") +
                    bone("b", 0.04,
                         floor ? "position: [0, 0, 0.04], rpy_deg: [0, 0, 70]"
                               : "position: [0, 0.05, 0], rpy_deg: [0, 0, 70]"));
}

State after(Scene scene, Method method, double rate, double seconds) {
  scene.solver = SolverSpec();
  scene.solver.method = method;
  scene.solver.events = method == Method::kRk;
  scene.solver.step = 1 / rate;
  scene.solver.sleep = false;
  World world(scene);
  const StepReport report = world.steps(static_cast<int>(std::lround(seconds * rate)));
  EXPECT_EQ(report.fast_fallbacks, 0);
  return world.state;
}

double farthest(const Points& a, const Points& b) { return (a - b).colwise().norm().maxCoeff(); }

TEST(FastTogether, HasTheLimitOfRkToFirstOrder) {
  for (const bool floor : {false, true}) {
    SCOPED_TRACE(floor);
    const Scene scene = crossingBones(floor);
    const State limit = after(scene, Method::kRk, 1000, 0.3);
    EXPECT_LT(farthest(after(scene, Method::kFast, 60, 0.3).x, limit.x), 8e-3);
    EXPECT_LT(farthest(after(scene, Method::kFast, 960, 0.3).x, limit.x), 1.2e-3);
    const State fine = after(scene, Method::kFast, 15360, 0.3);
    EXPECT_LT(farthest(fine.x, limit.x), 6e-5);
    EXPECT_LT(farthest(fine.v, limit.v), 1e-3);
  }
}

/// Friction acts on the axes, which are apart; what that takes comes back as a spin.
TEST(FastTogether, KeepsMomentaOfWhatNothingElseTouches) {
  for (const double rate : {60.0, 480.0}) {
    Scene scene = crossingBones(false);
    scene.ragdolls[1].angular_velocity = Vec3(0.5, 0.3, 0.8);
    const State start = after(scene, Method::kFast, rate, 0),
                end = after(scene, Method::kFast, rate, 1);
    const Model model = buildModel(scene);
    EXPECT_LT(kineticEnergy(model, end), 0.9 * kineticEnergy(model, start));  // they have met
    EXPECT_LT((momentum(model, end) - momentum(model, start)).norm(), 1e-12);
    EXPECT_LT((angularMomentum(model, end) - angularMomentum(model, start)).norm(),
              1e-8 * angularMomentum(model, start).norm());
  }
}

/// An old overlap opens, whatever the step, by what they have.
TEST(FastTogether, KeepsMomentaWhereBodiesOverlap) {
  for (const double rate : {60.0, 960.0}) {
    const Scene scene = parseScene(
        "gravity: [0, 0, 0]\nragdoll_collision: true\nragdolls:\n"
        "  - {name: a, model: human, rpy_deg: [0, 90, 0]}\n"
        "  - {name: b, model: human, rpy_deg: [0, 90, 0], position: [0.3, 0.05, 0.14], velocity: "
        "[0, 0, -0.3]}\n");
    const Model model = buildModel(scene);
    const State start = startState(model), end = after(scene, Method::kFast, rate, 0.5);
    EXPECT_LT((momentum(model, end) - momentum(model, start)).norm(), 1e-10);
    EXPECT_LT(kineticEnergy(model, end), kineticEnergy(model, start));
  }
}

/// On a bone that presses on another.
TEST(FastTogether, APokeGivesItsImpulseWhateverItTouches) {
  Scene scene = crossingBones(false);
  PokeSpec poke;
  poke.at = 0.25;  // they touch from 0.23 s on
  poke.body = "a/p";
  poke.force = Vec3(0, 10, -40);
  poke.duration = 0.1;
  scene.pokes = {poke};
  const Model model = buildModel(scene);
  const Vec3 start = momentum(model, startState(model));
  for (const double rate : {60.0, 960.0}) {
    const State end = after(scene, Method::kFast, rate, 0.5);
    EXPECT_LT((momentum(model, end) - start - poke.duration * poke.force).norm(), 1e-10) << rate;
  }
}

TEST(FastTogether, HeapsHoldTogetherAndComeToRest) {
  std::mt19937 random(23);
  StepReport all;
  long steps = 0;
  std::vector<double> overlaps;
  double rise = 0;
  for (int heap = 0; heap < 8; ++heap) {
    SCOPED_TRACE(heap);
    Scene scene = randomPile(3, random);
    const double damping = scene.solver.damping, joint_damping = scene.solver.joint_damping;
    scene.solver = preset("fast");
    scene.solver.damping = damping;
    scene.solver.joint_damping = joint_damping;
    World world(scene);
    for (int i = 0; i < 900; ++i) {
      const double before =
          kineticEnergy(world.model, world.state) + potentialEnergy(world.model, world.state);
      for (const std::uint8_t asleep : world.state.asleep) steps += !asleep;
      all += world.steps(1);
      overlaps.push_back(std::max(deepestBetween(world), deepestSelfPair(world)));
      rise = std::max(rise, kineticEnergy(world.model, world.state) +
                                potentialEnergy(world.model, world.state) - before);
    }
    EXPECT_LT(maxStickError(world.model, world.state), 1e-9);
    EXPECT_EQ(std::count(world.state.asleep.begin(), world.state.asleep.end(), 0), 0);
  }
  std::sort(overlaps.begin(), overlaps.end());
  EXPECT_LT(overlaps[overlaps.size() / 2], 1e-3);
  EXPECT_LT(overlaps.back(), 15e-3);
  EXPECT_LT(rise, 1);
  EXPECT_LT(all.fast_fallbacks, 0.01 * static_cast<double>(steps));
}

}  // namespace
}  // namespace ragdoll
