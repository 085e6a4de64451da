// Friction between two sticks acts on their axes, which are apart: two opposite forces that are a
// couple. Of bodies on which nothing outside presses angular momentum stays: as in steps of shake
// (angular_momentum.h) it comes back as a spin of all that press on each other, at once.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Which rows count: those that press, or all that are closed.
enum class SpinOf { kPressing, kClosed };

/// Mode::spins <- of the bodies at x, by the rows of contacts between sticks.
void findSpins(Island& island, const double* x, SpinOf which);

/// Takes from A what friction does to friction by these couples; mode.place and .first are known.
void coupleFriction(const Island& island, ModeMatrix& A);

/// Adds to motions `out` the spins that go with p, at x.
void addSpins(const Island& island, const ModeVector& p, const double* x, double* out);

}  // namespace ragdoll
