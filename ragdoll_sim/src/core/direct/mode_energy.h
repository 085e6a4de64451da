// Energy in an impact of rk from event to event (impact_energy.h).
#pragma once

#include <vector>

#include "core/direct/island.h"
#include "core/direct/mode_solve.h"

namespace ragdoll {

/// energies <- the bodies' kinetic energies [J] at the point.
void findEnergies(const Island& island, const ModePoint& point, std::vector<double>& energies);

/// Takes what an impact with impulses p has given out of the velocities of those that it pressed
/// on: of each group that it pressed together what that has gained. before: the bodies' kinetic
/// energies [J] before it.
void takeImpactGains(Island& island, const ModeVector& p, const std::vector<double>& before,
                     ModePoint& point);

}  // namespace ragdoll
