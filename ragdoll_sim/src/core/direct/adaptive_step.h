// A step within the scene's tolerance: parts of it, each of which is a step of its own. The error of
// a part in which nothing touches is that of rk's embedded formula; of any other leapfrog's defect,
// or the difference to its two halves. docs/equations.md#tolerance.
#pragma once

#include <vector>

#include "core/direct/island.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

/// Moves an island by the whole step; afterwards its places are as its last part left them.
void stepWithinTolerance(const StepContext& context, const std::vector<int>& bodies,
                         const std::vector<int>& sleepers, StepReport& report);

}  // namespace ragdoll
