// Where a scene's particles end, and how far that is from elsewhere.
#pragma once

#include <cmath>

#include "support/worlds.h"

namespace ragdoll::test {

/// After `seconds` at `rate` steps a second.
inline Points endOf(Scene scene, Method method, double rate, double seconds) {
  scene.solver.method = method;
  scene.solver.step = 1 / rate;
  World world(scene);
  world.steps(static_cast<int>(std::lround(seconds * rate)));
  return world.state.x;
}

/// After `seconds` in steps of `h`, by the scene's own method; counts the steps of rk that were
/// handed over.
inline State stateInSteps(Scene scene, double h, double seconds, int* handed_over = nullptr) {
  scene.solver.step = h;
  World world(scene);
  const int steps = static_cast<int>(std::lround(seconds / h));
  for (int n = 0; n < steps; ++n) {
    const int over = world.steps(1).handed_over;
    if (handed_over) *handed_over += over;
  }
  return world.state;
}
inline Points endInSteps(const Scene& scene, double h, double seconds, int* handed_over = nullptr) {
  return stateInSteps(scene, h, seconds, handed_over).x;
}

/// The same with nothing asleep, by rk from event to event.
inline State stateOfImpacts(Scene scene, Method method, double h, double seconds) {
  scene.solver.method = method;
  scene.solver.events = method == Method::kRk;
  scene.solver.sleep = false;
  return stateInSteps(scene, h, seconds);
}
inline Points endOfImpacts(const Scene& scene, Method method, double h, double seconds) {
  return stateOfImpacts(scene, method, h, seconds).x;
}

/// Of a particle's distances or velocities.
inline double largest(const Points& d) { return d.colwise().norm().maxCoeff(); }

}  // namespace ragdoll::test
