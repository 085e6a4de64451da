// What a motion touches and leaves again before its end, as a rod's tip that turns past a floor:
// gaps at both ends do not show it.
#pragma once

#include "core/direct/body.h"

namespace ragdoll {

/// [s] Of a motion over h that ends with velocities v1 (3 x n, [m/s]), of a body whose candidates
/// are known: the first time at which something that it touches in between is nearest, by cubics
/// through gaps and rates at both ends. h: there is nothing.
double timeOfGraze(const Body& body, const Points& v1, double h);

}  // namespace ragdoll
