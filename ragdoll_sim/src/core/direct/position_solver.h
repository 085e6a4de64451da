// The position stage: motions so that no contact and no limit is violated and every stick has its
// length. Contacts and limits by the Schur complement over the sticks, then Newton on the sticks,
// in turn until nothing is violated (docs/equations.md#contacts-and-limits).
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Of explicit steps, along the directions at the start; contacts: counts those that press. False:
/// no motion was found; a smaller one may be.
bool solvePositions(Island& island, double h, int& contacts);

/// Of implicit steps, along the directions at the end.
bool solvePositionsImplicitly(Island& island, double h);

}  // namespace ragdoll
