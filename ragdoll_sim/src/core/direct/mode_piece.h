// A piece of motion in a mode, without events: Dormand-Prince 5 (docs/equations.md#event-driven-rk,
// [Hairer1993, II.5, II.6]).
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Moves mode.start, whose accelerations are known, by h to `end`, through the stages of `piece`.
/// False: no motion was found.
bool moveInMode(Island& island, double h, ModePoint& end, ModePiece& piece);

/// [m/s] of such a piece over h to mode.end, whose accelerations are known: by the embedded formula
/// of fourth order.
double errorOfPiece(Island& island, double h, const ModePiece& piece);

/// [m/s] Of the fastest particle, and of what moves there.
double fastest(const Island& island, const ModePoint& point);

/// x and v at a share of a motion over h, by polynomials of degree 5 and 3 through both ends.
void interpolate(const ModePoint& start, const ModePoint& end, double h, double share,
                 ModePoint& out);

}  // namespace ragdoll
