// What may press on a body in a motion through contact (mode_motion.h): a particle or a stick on an
// obstacle that stands still, or a hard joint limit; each as a function of the pose that is smooth
// while it presses, with what its second derivative along a motion takes.
#pragma once

#include <vector>

#include "core/direct/body.h"

namespace ragdoll {

/// Lists in mode.rows all that a motion over h may reach, and what it cannot be: false where
/// something is deep in an obstacle, gives way, or moves.
bool listModeRows(Body& body, double h, Mode& mode);

/// Where the row stands at x, v (coordinates of the body's first particle). What is not asked for is
/// left out: curvature of limits is dear.
RowPlace placeOf(Body& body, const ModeRow& row, const double* x, const double* v, bool curvature);

/// [m], [rad] its gap alone.
double gapOf(Body& body, const ModeRow& row, const double* x);

/// How far the place where a pressing row touches is from leaving what it is smooth on: the feature
/// (face, edge, corner) of the obstacle, the length of the stick. feature: as RowPlace::feature.
double roomOf(Body& body, const ModeRow& row, const double* x, const std::array<int, 3>& feature);

}  // namespace ragdoll
