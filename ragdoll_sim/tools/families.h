// What there is to choose from: solver methods and their knobs. A family is a method with all knobs
// set but the step; a configuration is a family at a step, or a preset.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/scene.h"

namespace ragdoll::lab {

struct Family {
  std::string name;  ///< "shake", "jakobsen 10": what tables and pictures call it
  SolverSpec solver;
  double coarsest = 0, finest = 0;  ///< [Hz] the steps that are worth a measurement
};

/// All families. The integrators of jakobsen's free motion are told apart only if asked for: where
/// there are sticks, the projection decides and they give the same error to three digits.
std::vector<Family> families(bool integrators);

/// The family's solver at `rate` [Hz].
SolverSpec at(const Family& family, double rate);

/// With the scene's damping, which belongs to what is simulated, not to how.
SolverSpec damped(SolverSpec solver, const SolverSpec& scene);

/// What is said after rk that goes from event to event.
constexpr const char* kWithEvents = " with events";

/// "shake", as a scene says it.
const char* methodName(Method method);
const char* integratorName(Integrator integrator);

/// The `solver:` section of a scene that gives these settings.
std::string toSection(const SolverSpec& solver);

}  // namespace ragdoll::lab
