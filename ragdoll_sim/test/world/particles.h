// The simplest worlds.
#pragma once

#include <string>

#include "../support/worlds.h"
#include "ragdoll_sim/core/scene.h"

namespace ragdoll::test {

constexpr double kStep = 0.001;  ///< [s] of particles()

/// Weightless particles of 1 kg, of one body each.
inline Scene particles(int count) {
  SkeletonSpec skeleton;
  skeleton.particles = {particle("p", Vec3::Zero())};
  Scene scene = sceneOf(skeleton);
  scene.gravity.setZero();
  scene.solver.step = kStep;
  scene.solver.sleep = false;
  for (int i = 1; i < count; ++i) {
    scene.ragdolls.push_back(scene.ragdolls[0]);
    scene.ragdolls.back().name = "other_" + std::to_string(i);
    scene.ragdolls.back().pose.position.x() = i;
  }
  return scene;
}

}  // namespace ragdoll::test
