// What counts as touching and as solved, in a step of h.
#pragma once

namespace ragdoll {

/// They shrink with the method's error, which is of second order.
struct Tolerances {
  double contact = 0;         ///< [m] violation that a solution may leave
  double touching = 0;        ///< [m] a gap smaller than that is closed
  double touching_angle = 0;  ///< [rad] likewise
};

Tolerances tolerancesFor(double h);

/// In parts of a step that may err by so much [m] in all. Of parts of any length alike: they do not
/// tell what else would follow if what counts as touching were still open.
Tolerances tolerancesWithin(double error);

}  // namespace ragdoll
