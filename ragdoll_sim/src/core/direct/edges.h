// When what presses on an obstacle goes over from one part of its surface to another, as from a
// face to an edge: there its force jumps, and what was fast enough leaves. A motion ends there, so
// that the order of the method survives it.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// [s] The first time at which a particle that touches goes over an edge of an obstacle, in motions
/// over h that are solved; more than h: none does.
double timeOfEdge(const Island& island, double h);

}  // namespace ragdoll
