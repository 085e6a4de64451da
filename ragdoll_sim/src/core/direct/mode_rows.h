// What may press in a motion through contact (mode_motion.h): a particle or a stick on an obstacle
// that stands still or on another body's or its own, or a joint limit; each as a function of the
// pose that is smooth while it presses, with what its second derivative along a motion takes.
#pragma once

#include <array>

#include "core/direct/island.h"

namespace ragdoll {

/// Where the row stands at x, v (the island's coordinates, Mode::offset). What is not asked for is
/// left out: curvature of limits is dear.
RowPlace placeOf(Island& island, const ModeRow& row, const double* x, const double* v,
                 bool curvature);

/// [m], [rad] its gap alone; of a body's own row, at the body's x.
double gapOf(Island& island, const ModeRow& row, const double* x);
double gapOfOwn(const Body& body, const ModeRow& row, const double* x);

/// [m/s], [rad/s] of the gap by the motion v of the bodies alone; [m/s^2] by accelerations.
double openingRateOf(const Island& island, const ModeRow& row, const RowPlace& place,
                     const double* v);

/// [m/s], [rad/s] of the gap.
double rateOf(const Island& island, const ModeRow& row, const RowPlace& place, const double* v);

/// [m] or [m/s] of a contact's point, or between its two, at positions or by velocities x.
Vec3 motionOf(const Island& island, const Contact& contact, const double* x);

/// [m/s], [rad/s] at which the damper of what gives way opens: of a stick as its springs do, whose
/// place moves.
double dampedRate(const Island& island, const ModeRow& row, const RowPlace& place, const double* x,
                  const double* v);

/// [m], [rad] How far it is from pressing: a rigid one's gap. What gives way presses where that is
/// negative, and its damper does not hold it back.
double openingOf(Island& island, const ModeRow& row, const double* x, const double* v);

/// How far the place where a pressing row touches is from leaving what it is smooth on: the feature
/// (face, edge, corner) of the obstacle, the length of the sticks. feature: as RowPlace::feature.
double roomOf(Island& island, const ModeRow& row, const double* x,
              const std::array<int, 3>& feature);

/// Whether it pressed in the last motion.
bool hasPressed(Island& island, const ModeRow& row, const RowPlace& place);

}  // namespace ragdoll
