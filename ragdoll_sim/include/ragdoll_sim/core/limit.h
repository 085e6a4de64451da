// Joint limits as geometry of particles: what a hinge or a cone of a model file becomes at load.
//
// Everything is an angle between directions, and every direction is carried by particles:
//   bone          from its first to its second particle
//   rigid group   fixed in the group: d = c_0 e + c_1 f + c_2 e x f, normalised, with e and f the
//                 two edges of a well-shaped triangle of its particles
//   bone's frame  a bone shows no twist, so a direction fixed in it is one fixed in ITS parent,
//                 carried along by the smallest rotation from `axis`, the middle of the bone's own
//                 joint's range, to where the bone points. Its one singular direction, -axis, is
//                 one that the bone's own limit forbids. In the rest pose it is what the file says.
// A limit is one-sided, C(X) >= 0, and depends on the particles through these directions alone: it
// does not change when the whole body is moved or turned, so its gradient has neither net force nor
// net torque, and a correction along W grad C keeps momentum and angular momentum.
//
// kWithin: C = angle - angle(reference, child).
//   cone           reference = its axis, fixed in the parent; angle = half_angle
//   hinge, u the parent bone, w the child bone, n = axis x u the direction it bends to:
//     flexion      angle(u, w) <= range.end (less if the axis is not square to u: bendOfTurn)
//     extension    angle(n, w) <= 90 deg - range.begin: for begin = 0 the half-space that n looks
//                  into. Straight (w = u) lies on its border, which is smooth there: a bend to the
//                  back is a violation however small, and there is no pole to flip at.
//     twist        n turned about u by +-(90 deg - twist): how far the plane of bending may turn
//                  about the parent bone. Shoulder (3) and elbow (1) have as many freedoms as the
//                  two bones' directions, so the half-space (twist = 90 deg) is all that a point
//                  body can know; less keeps the axis nearer to where the file puts it.
// kTurn: C = (angle - |phi|) r, where r and phi are the polar coordinates of the child in the plane
//   of `reference` (the middle of the range) and `normal`. For hinges whose twist keeps the child
//   away from the axis, r = 0, where its direction has a jump.
//
// A range whose child may point along the axis - a region of a `planes` joint (plane_limits.h), a
// hinge with a twist of 90 deg on a rigid parent or with a range beyond +-90 deg - is bordered by
// two great circles through the axis, and C is the angle to them:
//   up to a half turn  two rows kWithin of 90 deg, n the circle's pole on the inside. A child that
//                      slides along one border over the axis meets the other: an impact.
//   more               kWedge, the angle to what is forbidden, a wedge narrower than a half turn:
//                      sin C = r sin(min(angle - |phi|, 90 deg)). Beyond the axis it is free. On
//                      the axis, the wedge's tip, it matters where the motion goes (LimitAngles).
// With one row (angle - |phi|) r it was thrown from one border to the other in a step, by a force
// square to neither: a body hung by its foot gained 1 kJ in a step.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "ragdoll_sim/core/types.h"

namespace ragdoll {

/// A unit vector that particles carry.
struct Direction {
  struct Swing {
    int from = 0, to = 0;  ///< the bone
    Vec3 axis;             ///< c of the swing's start direction, see above
  };
  static constexpr int kMaxSwings = 2;
  std::array<int, 3> base{};  ///< particles of the skeleton; e = x1 - x0, f = x2 - x0
  Vec3 c = Vec3::UnitX();     ///< a bone: (1, 0, 0), base[2] unused
  bool bone = false;
  int swings = 0;
  std::array<Swing, kMaxSwings> swing;
};

/// One constraint C(X) >= 0 of one joint.
struct Limit {
  enum class Kind { kWithin, kTurn, kWedge };
  Kind kind = Kind::kWithin;
  int joint = 0;
  Direction reference, child;
  Direction normal;     ///< kTurn, kWedge
  bool region = false;  ///< of a `planes` joint: for the direct methods
  double angle = 0;     ///< [rad] in (0, pi)
  double sin_angle = 0, cos_angle = 1;
  double compliance = 0;  ///< [rad/(N m)] 1 / stiffness; 0: hard
  double damping = 0;     ///< [N m s/rad]
};

/// A `planes` joint, resolved (plane_limits.h).
struct PlaneLimit {
  struct Region {
    bool used = false;
    Vec3 middle, side;  ///< unit, in the parent's rest axes: the region's middle, 90 degrees on
    double centre = 0;  ///< [rad] of the middle
    double half = 0;    ///< [rad] from the middle to begin and end
    double cos_half = 1;
  };
  int joint = 0;
  std::array<Direction, 3> axes;  ///< the parent's rest axes, carried
  Direction child;                ///< a bone
  double compliance = 0;          ///< [rad/(N m)]
  double damping = 0;             ///< [N m s/rad]
  std::array<Region, 3> regions;
};

}  // namespace ragdoll
