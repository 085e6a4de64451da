// The spring and the damper of a contact that gives way, or of a soft limit, which only push:
//
//   force = max(0, -k g - d dg/dt)   where the gap g < 0.
//
// docs/equations.md#compliant-contact. Units are of contacts; a limit has [rad] for [m], [N m] for
// [N]. Pure functions.
#pragma once

#include "core/contact/contact.h"

namespace ragdoll {

/// As a row of the position stage: gap + offset + compliance p >= 0, p >= 0, one of the two zero.
struct SpringRow {
  double offset = 0;      ///< [m]
  double compliance = 0;  ///< [1/kg]
  double answer = 0;      ///< [1/kg] of the body to a push along the normal

  /// [m] of the row, at a gap [m] after p [kg m]; what is rigid has neither offset nor compliance.
  double slack(double gap, double p) const { return gap + offset + compliance * p; }
};

/// before: [m] gap at the start of h [s]. leapfrog: the force acts in its middle, and p = h^2/2
/// force; else at its end (backward Euler), p = h^2 force.
SpringRow springRow(const Compliance& give, double before, double h, double answer, bool leapfrog);

/// [N s] that the spring gives in all of a motion over h in which it lets go, as it ends at `gap`
/// [m] after `half` [N s] of the position stage; 0: it does not let go. The motion gains what the
/// spring holds, F^2 / 2k by its force F at the start, and no more.
double releaseImpulse(const Compliance& give, double before, const SpringRow& row, double gap,
                      double half, double h);

/// [N s/m] of the damper over h [s]: never so much that it would throw back.
double effectiveDamping(const Compliance& give, double h, double answer);

/// The ends of a motion over h [s].
struct SpringMotion {
  double h = 0;
  double gap[2] = {0, 0};   ///< [m] at its start and end
  double rate[2] = {0, 0};  ///< [m/s] at which the gap opens, likewise
  double answer = 0;        ///< [1/kg]
  double force = 0;         ///< [N] mean
};

/// [N] largest in the motion, also where that lies inside it: there by the ellipse on which a mass
/// on a spring moves under a constant force.
double peakForce(const Contact& contact, const SpringMotion& motion);

}  // namespace ragdoll
