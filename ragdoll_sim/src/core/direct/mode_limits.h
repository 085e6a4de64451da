// Joint limits as rows of a mode (mode.h): where they stand, and how their gaps curve.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// [rad/s] of its gap at the body's velocities v [m/s], 3 x n one after the other.
double rateOfLimit(const Body& body, const LimitRow& limit, const double* v);

/// The border of a wedge that a limit presses at, also where a motion leads beyond its tip; 0:
/// none.
int borderOf(const ModeRow& limit);

/// place <- its gap [rad] and gradient at the body's positions x [m], 3 x n one after the other;
/// and with `curvature` the second derivative of the gap along v [m/s].
void placeLimit(Body& body, const ModeRow& row, const double* x, const double* v, bool curvature,
                RowPlace& place);

}  // namespace ragdoll
