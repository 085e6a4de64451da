// The step guard of the relaxation: what the sweeps could not take is done again by an implicit
// step.
//
// Relaxation is backward Euler, solved by a few sweeps of Gauss-Seidel. Where these leave a stick
// far from its length, a particle inside an obstacle or beyond it, more energy than there can be,
// or no number, the body goes back to the step's start and takes the same equation solved by
// Newton's method, with all that stands behind it (core/direct/implicit.h). On scenes that the
// sweeps can take nothing changes, not a bit. docs/equations.md#guard.
#pragma once

#include "core/direct/body.h"
#include "core/relaxation/workspace.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

/// After the sweeps and the velocities: ws.x0, ws.v0 are the step's start, ws.x1 the free motion.
void guardRelaxation(const StepContext& context, RelaxationWorkspace& ws, StepReport& report);

/// After that: bodies that press on each other can give each other energy, but have no more
/// together, as contact only takes. The surplus goes out of their motion. The thesis has one body.
void limitPairEnergy(const StepContext& context, RelaxationWorkspace& ws, StepReport& report);

}  // namespace ragdoll
