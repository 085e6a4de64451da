// What may press on a body in a motion through contact (mode_motion.h): a particle or a stick on an
// obstacle that stands still, or a joint limit; each as a function of the pose that is smooth
// while it presses, with what its second derivative along a motion takes.
#pragma once

#include <vector>

#include "core/direct/body.h"

namespace ragdoll {

/// Lists in mode.rows all that a motion over h may reach, and what it cannot be: false where
/// something is deep in a rigid obstacle, or moves.
bool listModeRows(Body& body, double h, Mode& mode);

/// Where the row stands at x, v (coordinates of the body's first particle). What is not asked for is
/// left out: curvature of limits is dear.
RowPlace placeOf(Body& body, const ModeRow& row, const double* x, const double* v, bool curvature);

/// [m], [rad] its gap alone.
double gapOf(Body& body, const ModeRow& row, const double* x);

/// [m/s], [rad/s] of the gap.
double rateOf(const ModeRow& row, const RowPlace& place, const Body& body, const double* v);

/// [m/s], [rad/s] at which the damper of what gives way opens: of a stick as its springs do, whose
/// place moves.
double dampedRate(const Body& body, const ModeRow& row, const RowPlace& place, const double* x,
                  const double* v);

/// [m], [rad] How far it is from pressing: a rigid one's gap. What gives way presses where that is
/// negative, and its damper does not hold it back.
double openingOf(Body& body, const ModeRow& row, const double* x, const double* v);

/// How far the place where a pressing row touches is from leaving what it is smooth on: the feature
/// (face, edge, corner) of the obstacle, the length of the stick. feature: as RowPlace::feature.
double roomOf(Body& body, const ModeRow& row, const double* x, const std::array<int, 3>& feature);

}  // namespace ragdoll
