// A particle or stick of a body on one of another body or of its own, as a row of a mode (mode.h).
// The gap is the least of |P(s) - Q(t)| - r1(s) - r2(t) along the two axes. Where that lies at an
// end the end's own row has it, as spheres; axes along each other touch by their ends, too. Two
// capsules that give way share one spring wherever they are nearest, so that all of that is one
// row, and two at the ends of their overlap where they lie along each other, as in capsule_pairs.h.
// While a row presses, a place that comes to an end, or leaves it, ends the mode
// (ModeRow::feature). Everything in the island's coordinates.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Lists the rows of two bodies (places in the island; the same: of its own pairs) within reach
/// [m]. False: something rigid is deep in.
bool listPairs(Island& island, int body, int other, double reach);

RowPlace placeOfPair(const Island& island, const ModeRow& row, const double* x, const double* v,
                     bool curvature);
double gapOfPair(const Island& island, const ModeRow& row, const double* x);

/// From the ends of the sticks, of their lengths; of what gives way at an end: how steeply the gap
/// grows from there, per length.
double roomOfPair(const Island& island, const ModeRow& row, const double* x);

/// Whether it pressed in the last motion, as sticks or as their ends.
bool pairHasPressed(const Island& island, const ModeRow& row);

}  // namespace ragdoll
