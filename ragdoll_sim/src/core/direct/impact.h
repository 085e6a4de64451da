// Limits and contacts that are reached inside a step: located in time, so that the impact falls
// where it belongs and the order of the method survives it (docs/equations.md#contacts-and-limits).
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// The first thing that motions over h reach.
struct Impact {
  double time = 0;       ///< [s]; more than h: nothing is reached
  Role* role = nullptr;  ///< of what is reached
};

/// Time at which start + rate t + q t^2 = 0, with q from the value `end` at h.
double timeOfZero(double start, double rate, double end, double h);

/// [m/s] approach above which a contact bounces: slower is rest. And above which it comes from
/// afar: the same, but for weak gravity.
double bounceSpeed(const StepContext& step, const Contact& contact);
double comingSpeed(const StepContext& step, const Contact& contact);

/// Marks as coming what the bodies, or two of them, come to from afar, faster than gravity would
/// bring them there: it does not press until it is reached.
void findComing(Body& body, double h);
void findComing(Island& island, double h);

/// Whether the motions go through something that is coming: they will be cut short.
bool reachesComing(const Island& island);

/// Of what comes: by motions in which all else presses already.
Impact firstImpact(Island& island, double h);

/// Marks that one as hit, and whatever else was coming as usual; and the latter alone, where a
/// motion ends at an edge (edges.h).
void takeImpact(Island& island, const Impact& impact);
void takeEdge(Island& island);

/// The time again at which what is hit is reached, by a motion of a lone body over h that should
/// have ended there, and that nothing has pushed.
double impactAgain(const Body& body, double h);
/// Of an island's, that what is hit may have pushed back to it; h: it was reached there.
double impactAgain(const Island& island, double h);

}  // namespace ragdoll
