// The step guard's first resort: backward Euler, of first order and dissipative, stable for any
// tension (docs/equations.md#guard).
#pragma once

#include "core/direct/body.h"

namespace ragdoll {

/// The motion of a backward Euler step over h without contacts, from the last motion's tension.
/// False: none was found.
bool solveImplicitMotion(Body& body, double h);

}  // namespace ragdoll
