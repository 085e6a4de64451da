// A step of an island, a lone body among them: what begins it, its substeps, what ends it.
#pragma once

#include "core/direct/island.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

/// Moves the island by the whole step.
void stepIsland(Island& island, StepReport& report);

/// Moves it by the whole step, by rk from event to event, or not at all and to be restored: false.
/// error: [m] of the motion.
bool stepThroughEvents(Island& island, double& error, StepReport& report);

/// Moves it by h, a part of the step, under the step guard: a trial that fails, gains energy or
/// whose tension outgrew its substep is taken back and done again (substep_control.h). Whether
/// energy was taken out of it.
bool takeSubsteps(Island& island, double h, StepReport& report);

}  // namespace ragdoll
