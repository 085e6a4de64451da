// What each of several pins of one body gave in a step, from the body's motion alone.
//
// Beside pins only sticks, limits and rigid groups act within a body, each along directions that its
// pose has. What every particle's momentum changed by, less what is known to act from outside, is
// those multipliers and the pins' impulses: a linear system, solved in the least squares. Where pins
// strain the body against each other, as the two ends of one stick, the smallest impulses are told.
#pragma once

#include <vector>

#include "ragdoll_sim/core/contact_log.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll {

/// [N s] that a step's momenta (3 x n, of the ragdoll's particles) changed by, beyond gravity,
/// damping, pokes and these contacts. before: velocities [m/s] at its start; x: positions (3 x N)
/// [m] in its middle; state: at its end.
Points unexplained(const Model& model, const Inputs& inputs,
                   const std::vector<ContactImpulse>& contacts, const Points& before,
                   const Points& x, const State& state, int ragdoll);

/// [N s] by each of the ragdoll's pins, in the order of Model::pins; of second order in the step.
/// x: positions (3 x N) [m] in the middle of the step; rest: unexplained(). Their sum is that of
/// `rest`.
std::vector<Vec3> impulsesByPins(const Model& model, int ragdoll, const Points& x, const Points& rest);

}  // namespace ragdoll
