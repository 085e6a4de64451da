// The velocity stage: no touching contact approaches, none slips more than friction allows; at an
// impact the fast ones bounce, by Newton's law (docs/equations.md#contacts-and-limits).
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Which velocities are solved for.
enum class Stage {
  kMotion,  ///< at the end of a motion over h
  kImpact,  ///< the same, where something is hit: what pressed over h does its part before
  kBounce,  ///< an impact at the present pose, without a motion
};

/// Keeps what touches at the end of the motion over h, with the position stage's impulses; the
/// rest does not act on velocities. h = 0: without impulses. leapfrog: springs act in its middle,
/// so that velocities get as much again.
void findTouching(Body& body, double h, bool leapfrog = true);

/// Springs of soft limits act on velocities; those with a damper join what touches.
void releaseSprings(Body& body, double h);

/// What the last solution of velocities pressed with [N s], by the rows of island.s.joint; null:
/// nothing touches. Until the next solution.
using VelocityImpulses = const RowValues*;

/// Makes the motions over h and solves their velocities. damping: [s] of it at the motion's end,
/// before its impact.
VelocityImpulses finishMotion(Island& island, double h, bool leapfrog, Stage stage, double damping);

/// Newton's impact law at the present pose for what touches.
VelocityImpulses bounce(Island& island);

/// Velocities of what touches at the end pose, which the response holds.
VelocityImpulses solveVelocities(Island& island, Stage stage, double h, double damping);

}  // namespace ragdoll
