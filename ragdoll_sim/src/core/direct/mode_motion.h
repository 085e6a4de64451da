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
