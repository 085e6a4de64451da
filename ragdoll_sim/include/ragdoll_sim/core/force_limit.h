// How large a force may be: one that numbers cannot hold is refused where it enters.
#pragma once

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Throws Error("force", ...) if the poke would give its ragdoll, in one step, more speed than
/// positions can follow: after a second at 1e10 m/s they are known to a micrometre no longer, and
/// sticks have no length. An offset counts by the body's size. All else is left to the step guard.
void checkForce(const Model& model, const Poke& poke);

}  // namespace ragdoll
