// Random falls in shipped scenes and what a user sees of them: the law and the bench share it.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/pairs.h"
#include "support/samples.h"
#include "support/worlds.h"

namespace ragdoll::test {

/// The shipped scene with its first ragdoll turned and thrown at random, without its pokes.
inline Scene randomFall(const std::string& name, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Scene scene = loadScene(name);
  scene.ragdolls.resize(1);
  scene.pokes.clear();
  RagdollSpec& r = scene.ragdolls[0];
  r.pose.orientation = Quat(unit(random), unit(random), unit(random), unit(random)).normalized() *
                       r.pose.orientation;
  r.pose.position.z() += 0.6;
  r.velocity += Vec3(unit(random), unit(random), unit(random));
  r.angular_velocity = 3 * Vec3(unit(random), unit(random), unit(random));
  return scene;
}

/// [mm] Overlap of capsules that may be left at a step's end: half a millimetre stays where it is,
/// more opens in 50 ms, and what a sweep cannot see (limbs that meet while others push them) is
/// found when it is there. 1200 falls and piles left 2.7.
constexpr double kOverlap = 4;

/// [J] in a step: what opens an overlap of millimetres lifts limbs.
constexpr double kStepRise = 0.1;

/// Humans turned and thrown at random that fall on a floor, each onto the one before; that touch
/// themselves and each other.
inline Scene randomPile(int bodies, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Scene scene = loadScene("two");
  scene.self_collision = scene.ragdoll_collision = true;
  const RagdollSpec human = scene.ragdolls[0];
  scene.ragdolls.clear();
  for (int i = 0; i < bodies; ++i) {
    RagdollSpec r = human;
    r.name = "human" + std::to_string(i);
    r.pose.orientation = Quat(unit(random), unit(random), unit(random), unit(random)).normalized();
    r.pose.position = Vec3(0.3 * unit(random), 0.3 * unit(random), 1.3 + 1.9 * i);
    r.velocity = Vec3(unit(random), unit(random), unit(random));
    r.angular_velocity = 3 * Vec3(unit(random), unit(random), unit(random));
    scene.ragdolls.push_back(r);
  }
  return scene;
}

/// Worst of all steps of all falls.
struct FallRecord {
  double limit_deg = 0;       ///< by which a joint limit is violated
  double stretch = 0;         ///< of a stick's length
  double penetration_mm = 0;  ///< of a particle's sphere in an obstacle
  double stick_mm = 0;        ///< of a stick between its ends in an obstacle
  double rise = 0;            ///< [J] of the energy above its start
  double step_rise = 0;       ///< [J] of the energy in one step
  double overlap_mm = 0;      ///< of bodies with themselves and each other, where they may touch
  int falls = 0;
  int resting = 0;   ///< of the falls: at the end nothing moves faster than 1 mm/s
  int sleeping = 0;  ///< of the falls: at the end all bodies sleep
};

/// Runs the scene until all bodies sleep, `seconds` at most.
inline void addFall(const Scene& scene, double seconds, FallRecord& record) {
  World world(scene);
  const auto energy = [&world] {
    return kineticEnergy(world.model, world.state) + potentialEnergy(world.model, world.state);
  };
  const double start = energy();
  double before = start;
  const int steps = static_cast<int>(std::lround(seconds / world.model.solver.step));
  const auto asleep = [&world] {
    const std::vector<std::uint8_t>& all = world.state.asleep;
    return std::all_of(all.begin(), all.end(), [](std::uint8_t one) { return one != 0; });
  };
  for (int i = 0; i < steps && !asleep(); ++i) {
    world.steps(1);
    record.limit_deg =
        std::max(record.limit_deg, maxLimitViolation(world.model, world.state) * 180 / M_PI);
    record.stretch = std::max(record.stretch, maxStickError(world.model, world.state));
    record.penetration_mm =
        std::max(record.penetration_mm, 1e3 * maxPenetration(world.model, world.state));
    record.stick_mm =
        std::max(record.stick_mm, 1e3 * maxStickPenetration(world.model, world.state));
    const double now = energy();
    record.rise = std::max(record.rise, now - start);
    record.step_rise = std::max(record.step_rise, now - before);
    before = now;
    if (world.model.self_collision)
      record.overlap_mm = std::max(record.overlap_mm, 1e3 * deepestSelfPair(world));
    if (world.model.ragdoll_collision)
      record.overlap_mm = std::max(record.overlap_mm, 1e3 * deepestBetween(world));
  }
  ++record.falls;
  record.sleeping += asleep();
  record.resting += world.state.v.colwise().norm().maxCoeff() < 1e-3;
}

}  // namespace ragdoll::test
