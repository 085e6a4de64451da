// Contacts that slip so slowly that friction turns them at once: where a body turns about what it
// lies on, places beside the pivot slip by micrometres a second, and friction turns their slips
// within s / (mu f_n A) = 1e-6 s. An explicit piece would have to be as short. This is a singularly
// perturbed system [Hairer1996, VI.1]: on its slow manifold a slip of speed s goes, to first order
// in that time, in the direction phi with
//   a(phi) = s phi0',   a(phi0) = 0,
// a the acceleration across it: of forces and positions alone, but for s.
// docs/equations.md#event-driven-rk.
#pragma once

#include "core/direct/island.h"
#include "core/direct/mode_motion.h"

namespace ragdoll {

/// Finds which rows slip so slowly at mode.start, whose forces are known, that a piece of h is
/// long, and sets directions and accelerations there. allowed: [m/s] of a velocity's error. lasts:
/// [s] until one of them is too fast. False: no accelerations were found.
bool findSlowSlips(Island& island, double h, double allowed, double& lasts);

/// None do, and accelerations at mode.start are as if none did. False: none did before.
bool leaveSlowSlips(Island& island);

/// None do.
void clearSlowSlips(Mode& mode);

/// Solves the system at `point` with slow slips along the directions in which they go on. False: no
/// answer.
bool solveSlowSlips(Island& island, ModePoint& point, ModeSystem& system);

}  // namespace ragdoll
