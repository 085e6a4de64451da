// How stiff a body's tension makes its motion, and what that allows of an explicit substep.
//
// Explicit steps are stable while h Omega < 2, Omega^2 the largest eigenvalue of the tension's
// stiffness (docs/equations.md#guard); the bound here is the largest row sum of |G| |2 m|, m the
// sticks' multipliers. Substeps keep h Omega below kStable.
#pragma once

#include "core/direct/body.h"

namespace ragdoll {

/// [1/s^2] Omega^2, a bound, of the last motion; and of other multipliers (s of them, per h^2).
double stiffness(Body& body);
double stiffnessOf(Body& body, const double* multipliers);

/// Whether a coarser bound, at a fraction of the cost, shows that h is stable.
bool isSoft(const Body& body, double h);

/// Whether h times Omega is beyond `share` of kStable.
bool exceedsStable(Body& body, double h, double share);

/// Whether the tension in a substep of h is enough for leapfrog's energy to swing with it.
bool swings(Body& body, double h);

/// Whether the tension in a substep of h has more than doubled its frequency, as at the start, in
/// an impact or under a new force, and holds it above kJump: nothing had said so before, and
/// leapfrog's energy rises by what its frequency's square does.
bool tensionJumped(Body& body, double h);

}  // namespace ragdoll
