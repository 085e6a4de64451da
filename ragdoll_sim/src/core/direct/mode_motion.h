// A mode (mode.h) at one instant: sticks, limits that press and closed contacts are equalities, in
// one solution at the level of accelerations, in an impact, or for positions and velocities that
// are put back on them. docs/equations.md#event-driven-rk.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// The rows' answers at a pose, as the bodies' Schur complements: those that are closed, or all
/// that press. Also sets mode.place.
struct ModeSystem {
  ModeMatrix A;
  ModeVector b, p;
};

/// Builds A at x for the closed rows and mode.blocks from their states. False: too many, or not
/// smooth there.
bool buildModeSystem(Island& island, const double* x, const double* v, bool curvature,
                     ModeSystem& system);

/// The system of the mode's equalities at the point, without what presses, for accelerations;
/// point.a <- likewise. False: as above.
bool buildAccelerations(Island& island, ModePoint& point, ModeSystem& system);

/// How the island's bodies answer to forces or impulses p of the last system, at x: added to
/// motions `out`.
void pushInMode(Island& island, const ModeVector& p, const double* x, double* out);

/// Vector along the surface from what it has along the two tangents of a row of the last system.
Vec3 alongSurface(const Island& island, int row, const Eigen::Vector2d& t);

/// Forces of the rows from the solution.
void keepForces(const Island& island, const ModeVector& p, ModeForces& forces);

/// point.a and forces by the mode at point.x, point.v. False: no answer.
bool accelerateInMode(Island& island, ModePoint& point);

/// What closed rows press with at `point`, and from it what the mode is. False: not unique.
bool findMode(Island& island, ModePoint& point);

/// Impact at `point` of what approaches: Newton's law and Coulomb's, all closed rows together.
bool takeModeImpact(Island& island, ModePoint& point);

/// Puts the velocities on the mode's equalities. begins: of the mode; what will slip, but does not
/// yet, stands still.
bool projectVelocities(Island& island, ModePoint& point, bool begins);
/// And positions.
bool projectPositions(Island& island, ModePoint& point);

/// [m/s] Slip of a contact whose place is known, at x, v: beside the spin of its bodies as one
/// (mode_spin.h).
Vec3 slipOf(const Island& island, const ModeRow& row, const RowPlace& place, const double* x,
            const double* v);

}  // namespace ragdoll
