// Fifth order while nothing touches: `method: rk`, at a fixed substep, and within a tolerance.
#pragma once

#include "core/direct/island.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

/// Moves a lone body by Dormand-Prince 5 over h, or to the first impact, which it takes.
/// Returns the time that took; 0: something touches, and the leapfrog has to do it. False in ok: no
/// motion was found.
struct SmoothTrial {
  double took = 0;
  bool ok = true;
};
SmoothTrial moveSmoothly(Island& island, double h);

/// The whole step of a lone body in substeps whose estimated error per simulated second stays
/// within the scene's tolerance; where something touches, substeps of the step guard.
void stepWithinTolerance(Island& island, double h, StepReport& report);

}  // namespace ragdoll
