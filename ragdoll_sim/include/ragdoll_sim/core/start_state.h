// Where a run begins. Starts agree with themselves: velocities that contradict pins, sticks, or
// limits and contacts that touch are projected onto what these leave free, by the mass matrix, once.
// docs/equations.md#starts.
#pragma once

#include <string>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// The scene's start. taken: kinetic energy [J] that its velocities lost to be consistent.
State startState(const Model& model, double* taken = nullptr);

/// After a change of pins: makes the velocities consistent with those that there are now. Returns
/// the kinetic energy [J] that this took.
double settlePins(const Model& model, State& state);

/// Tells it in words; empty: nothing worth telling.
std::string takenText(double taken);

}  // namespace ragdoll
