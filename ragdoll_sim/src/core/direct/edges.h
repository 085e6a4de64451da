// When what presses goes over from one part of a surface to another, as from a face of an obstacle
// to an edge, or from a stick's side to its end, and when a limit leaves the border of a wedge:
// there its force jumps, and what was fast enough leaves. A motion ends there, so that the order of
// the method survives it.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// [s] The first time at which a particle or stick that touches goes over an edge of an obstacle,
/// or over an end of a stick, or a limit over the tip of a wedge, in motions over h that are
/// solved; more than h: none does.
double timeOfEdge(const Island& island, double h);

/// [s] The same of a body's limits, whose candidates are known, that touch at the start.
double timeOfTip(const Body& body, double h);
double timeOfTip(const Island& island, double h);

}  // namespace ragdoll
