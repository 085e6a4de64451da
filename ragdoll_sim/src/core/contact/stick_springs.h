// How a stick gives way on a box: by a spring at each of its ends, between which its surface stays
// straight and outside. Of all such springs the least energy is
//
//   U = max over t of depth(t)^2 / 2 C(t),   C(t) = (1 - t)^2 c_a + t^2 c_b
//
// c: the springs' compliances. It is a smooth function of the pose wherever the depth is: the place
// t where the springs' force acts moves along the stick, but never jumps.
// docs/equations.md#compliant-contact.
#pragma once

#include "core/contact/axis.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// The springs at a stick's ends.
struct StickEnds {
  Compliance a, b;

  /// [m/N] of both under a force at a place t.
  double complianceAt(double t) const {
    return (1 - t) * (1 - t) * a.compliance + t * t * b.compliance;
  }
  /// [N s/m] of their dampers: what takes as long to give way as they do.
  double dampingAt(double t) const;
};

/// Where a stick presses, and how, in the obstacle's frame.
struct StickPress {
  double at = 0;     ///< where the springs' force acts
  double depth = 0;  ///< [m] there; 0 and less: it does not press
  Vec3 normal;       ///< unit
  double share = 1;  ///< of the force that is along it: at an edge within the solid less than 1
  /// [m] by which a spring is deeper than its end, at the place's distance from the ends at most.
  double excess = 0;
  bool between = false;  ///< so the ends' own contacts are not enough
  /// Its depth is linear, as over a face: where the force acts is up to the springs.
  bool flat = false;

  /// [N] of the springs.
  double force(const StickEnds& ends) const {
    return depth > 0 ? depth / ends.complianceAt(at) : 0;
  }
};

StickPress pressOf(const Axis& axis, const StickEnds& ends);

/// The same of a stick that pressed so before: at that place.
StickPress pressedAt(const Axis& axis, const StickPress& before);

/// Whether a stick that gives way so rests on the springs of its ends.
inline bool restsOnEnds(const Model& model, const Obstacle& obstacle, const Compliance& give) {
  return give.compliance > 0 && obstacle.type == ObstacleSpec::Type::kBox &&
         model.solver.method != Method::kJakobsen;
}

/// How many sticks have a part of the spring of a particle (of the skeleton) against an obstacle.
int sticksAt(const Model& model, const Obstacle& obstacle, const Ragdoll& ragdoll, int particle);

/// The springs at the ends a, b (of the state) of a stick that gives way so by itself: the
/// particles' own, in equal parts for all their sticks; of a particle that is rigid the stick's.
StickEnds endsOf(const Model& model, const Obstacle& obstacle, const Ragdoll& ragdoll, int a, int b,
                 const Compliance& give);

}  // namespace ragdoll
