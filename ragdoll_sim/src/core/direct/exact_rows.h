// What presses, where sweeps give up: as in an impact on a limb between another body and the floor,
// where what sticks on one side decides what slides on the other.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// p of all rows in s.joint from b (gaps or rates), exactly (mode_solve.h); what is locked or given
/// stays. False: they are too many, or not one answer was found; p is as it was.
bool solveExactly(Island& island, const RowValues& b, RowValues& p);

}  // namespace ragdoll
