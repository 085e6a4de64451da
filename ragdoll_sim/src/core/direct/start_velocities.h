// Velocities that contradict nothing: those nearest in the mass metric with which pins stand,
// sticks keep their lengths, and no limit or contact that touches closes. An inelastic impact
// without friction, that takes energy and gives none. docs/equations.md#starts.
#pragma once

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// Changes state.v only, and of a body that contradicts nothing not a bit. Returns the kinetic
/// energy [J] that it took.
double makeConsistent(const Model& model, State& state);

}  // namespace ragdoll
