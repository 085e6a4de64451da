// The thesis's method: free motion, then sweeps of relaxation over sticks and contacts.
// [Pascucci2007, sec. 3.2, 4.3.2], [Jakobsen2001]. First order in time and dissipative whatever the
// number of sweeps, because it projects along the new stick directions; robust at any step.
#pragma once

#include "core/direct/body.h"
#include "core/relaxation/workspace.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

/// Moves x and v by h; time, step count and obstacles are the caller's.
void stepJakobsen(const StepContext& context, RelaxationWorkspace& ws, StepReport& report);

}  // namespace ragdoll
