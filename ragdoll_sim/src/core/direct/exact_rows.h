// What presses, where sweeps give up: as where a light body is wedged under a heavy one, each sweep
// gets the impulses nearer by a share of the ratio of their masses.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// p of all rows in s.joint from b (gaps or rates), exactly (mode_solve.h); what is locked or given
/// stays. False: they are too many, or not one answer was found; p is as it was.
bool solveExactly(Island& island, const RowValues& b, RowValues& p);

}  // namespace ragdoll
