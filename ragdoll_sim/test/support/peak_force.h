// How hard the hardest contact of a run pressed.
#pragma once

#include <algorithm>

#include "ragdoll_sim/world/contacts.h"
#include "support/worlds.h"

namespace ragdoll::test {

/// [N] largest of one contact in 100 steps.
inline double peakForce(World& world) {
  Contacts contacts(world.model);
  world.workspace.keepContacts(&contacts.log());
  double peak = 0;
  for (int i = 0; i < 100; ++i) {
    contacts.begin(world.state);
    world.steps(1);
    contacts.end(world.model, world.inputs, world.state);
    for (const Touch& t : contacts.take().touches) peak = std::max(peak, t.peak_force);
  }
  return peak;
}

inline double peakForce(const Scene& scene) {
  World world(scene);
  return peakForce(world);
}

}  // namespace ragdoll::test
