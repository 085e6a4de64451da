// Fifth order: `method: rk`, at a fixed substep, and while nothing touches within a tolerance.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Moves a lone body by Dormand-Prince 5 over h: while nothing touches, else from event to event
/// (mode_events.h), and where that is not possible to the first impact, which it takes.
/// False in ok: no motion was found.
struct SmoothTrial {
  double took = 0;  ///< [s]; 0 of an impact at the start
  bool ok = true;
  bool is_left = false;  ///< something touches, and the leapfrog has to do it
  bool exact = false;    ///< through events
  int contacts = 0;      ///< that press
  double error = 0;      ///< [m] in a part of a step
};
SmoothTrial moveSmoothly(Island& island, double h);

/// Moves bodies that may touch each other from event to event over h.
SmoothTrial moveTogether(Island& island, double h);

/// Moves a lone body by it over h, whose error [m] is then known. False: it meets something or no
/// motion was found, and what it has done is to be taken back.
bool moveFreely(Island& island, double h, double& error);

}  // namespace ragdoll
