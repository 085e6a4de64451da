// Fifth order while nothing touches: `method: rk`, at a fixed substep, and within a tolerance.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Moves a lone body by Dormand-Prince 5 over h, or to the first impact, which it takes.
/// Returns the time that took; 0: something touches, and the leapfrog has to do it. False in ok: no
/// motion was found.
struct SmoothTrial {
  double took = 0;
  bool ok = true;
};
SmoothTrial moveSmoothly(Island& island, double h);

/// Moves a lone body by it over h, whose error [m] is then known. False: it meets something or no
/// motion was found, and what it has done is to be taken back.
bool moveFreely(Island& island, double h, double& error);

}  // namespace ragdoll
