// Friction between two sticks acts on their axes, which are apart: two opposite forces that are a
// couple. Of bodies on which nothing outside presses angular momentum stays: as in steps of shake
// (angular_momentum.h) it comes back as a spin of all that press on each other, at once. The couple
// does work on that spin, so that what slips is measured against it: bodies that turn together as
// one do not slip on each other, and friction gives no energy.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Which rows count: those that press, or all that are closed; each: of those that press, and of
/// every body that nothing presses on.
enum class SpinOf { kPressing, kClosed, kEach };

/// Mode::spins <- of the bodies at x that move by v, by the rows of contacts between sticks.
void findSpins(Island& island, const double* x, const double* v, SpinOf which);

/// [m/s] Of a row's places against each other, as the spin at x, v of its bodies has it: no slip.
Vec3 spinMotion(const Island& island, const ModeRow& row, const RowPlace& place, const double* x,
                const double* v);

/// Takes it, and how it changes at the point, from rates and accelerations along the tangents
/// of the rows.
void takeSpinRates(const Island& island, ModeVector& rates);
void takeSpinAccelerations(const Island& island, const ModePoint& point, ModeVector& accelerations);

/// Takes from A what friction does to friction by these couples; mode.place and .first are known.
void coupleFriction(const Island& island, ModeMatrix& A);

/// Gives back to the velocities, as spins, what angular momentum bodies had when Mode::spins were
/// found, before their positions were changed: what shake leaves of gaps is some 1e-6 m.
void keepSpins(const Island& island, ModePoint& point);

/// The same of what a piece over h [s] from `start` errs of it: nothing of bodies that pokes push.
void keepSpins(Island& island, const ModePoint& start, double h, ModePoint& end);

/// Adds to motions `out` the spins that go with p, at x.
void addSpins(const Island& island, const ModeVector& p, const double* x, double* out);

}  // namespace ragdoll
