// A body's motion before it meets anything: leapfrog with the sticks solved directly.
//
//   SHAKE [Ryckaert1977]:   v_half = v + h/2 a
//                           dx = h v_half + D0 diag(lambda) (B W)         with |d1| = L
//   RATTLE [Andersen1983]:  v1 = dx / h + h/2 a + D1 diag(kappa) (B W)    with d1 . d1' = 0
// In increments dx, so that nothing is lost far from the origin (docs/equations.md#shake).
#pragma once

#include "core/direct/body.h"

namespace ragdoll {

/// The motion over h, which starts at the present pose; the multipliers follow it. False: no pose
/// with these lengths was found.
bool freeMotion(Body& body, double h);

/// Newton along the old directions until every stick has its length; and along the new ones.
bool satisfySticks(Body& body);
bool satisfySticksAlongNew(Body& body);

/// Makes the motion over h: positions, and velocities before what touches acts on them. leapfrog:
/// else they are those of backward Euler.
void makeMotion(Body& body, double h, bool leapfrog);

}  // namespace ragdoll
