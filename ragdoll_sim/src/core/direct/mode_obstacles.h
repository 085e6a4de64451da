// A particle or a stick of a body on an obstacle, which may move, as a row of a mode (mode.h). x,
// v: the body's coordinates, with its clock (clockPlace).
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

RowPlace placeOnObstacle(const Body& body, const ModeRow& row, const double* x, const double* v,
                         bool curvature);

double gapToObstacle(const Body& body, const ModeRow& row, const double* x);

/// As roomOf (mode_rows.h).
double roomOnObstacle(const Body& body, const ModeRow& row, const double* x,
                      const std::array<int, 3>& feature);

/// [m/s] Of the gap of a stick that gives way, at which its damper closes as its place moves along
/// it; 0 of others.
double shiftedRate(const Body& body, const ModeRow& row, const RowPlace& place, const double* x,
                   const double* v);

/// Of what gives way, how far it is from where other rows have its spring; negative: within.
double openingElsewhere(const Body& body, const ModeRow& row, const RowPlace& place,
                        const double* x);

/// Whether at the body's positions x a stick touches a box at two opposite edges at once: one row
/// is not enough.
bool liesAcross(const Body& body, const ModeRow& stick, const double* x);

/// Whether a particle is the end of a stick that touches beside one edge or corner, or what is
/// round: the place where that touches has to run there first. x: the island's coordinates.
bool isEndOfTouchingStick(const Island& island, const ModeRow& particle, const double* x);

/// Whether it is that a moment later, at positions `later`, and at x already, or the place is at
/// it.
bool passesToStick(const Island& island, const ModeRow& particle, const double* x,
                   const double* later);

}  // namespace ragdoll
