// Energy in an impact of rk from event to event. Newton's restitution with Coulomb's friction may
// give some where a body is hit off its middle [Stronge1990]: it is taken out at once, as shake
// takes it out of a substep (mechanics/energy_removal.h).
#pragma once

#include "core/direct/island.h"
#include "core/direct/mode_solve.h"

namespace ragdoll {

/// island.s.energies <- the bodies' kinetic energies [J] at the point.
void keepEnergies(Island& island, const ModePoint& point);

/// Takes what an impact with impulses p has given since then out of the velocities of those that it
/// pressed on: of each group that it pressed together what that has gained.
void takeImpactGains(Island& island, const ModeVector& p, ModePoint& point);

}  // namespace ragdoll
