// One substep as it comes: whether it may stand is judged afterwards (step_island.h).
#pragma once

#include "core/direct/island.h"
#include "core/direct/substep_control.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

/// What a trial came to.
struct Trial {
  double took = 0;           ///< [s]
  bool ok = true;            ///< false: no motion was found
  int contacts = 0;          ///< that pressed
  bool exact = false;        ///< by rk from event to event
  bool handed_over = false;  ///< rk was asked for, and this is leapfrog
  bool limited = false;      ///< energy was taken out within
  double turn = 0;           ///< [s] when a slip turned back within (slip_turns.h); 0: none did
  double defect = 0;         ///< [m] in a part of a step: leapfrog's, or as much of rk's error
};

/// By the control's way, over its substep or to the first impact.
Trial takeTrial(Island& island, const SubstepControl& control, StepReport& report);

/// The explicit one over h.
Trial takeExplicitTrial(Island& island, double h);

}  // namespace ragdoll
