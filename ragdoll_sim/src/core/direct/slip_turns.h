// When what slides comes to rest and slides back, as a ball that goes up a slope and down again:
// there the friction jumps to its other side. A motion ends there, so that the order of the method
// survives it.
#pragma once

#include "core/direct/velocity_solver.h"

namespace ragdoll {

/// [s] The first time at which some slip turns back, in motions over h whose velocities are solved;
/// more than h: none does, or as many impacts of the step as may be have been located.
double timeOfTurn(Island& island, const VelocitySolution& solution, double h);

}  // namespace ragdoll
