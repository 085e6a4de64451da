// A stick's capsule beside one obstacle, in the obstacle's frame: where it is nearest, and how far
// it lies flat.
#pragma once

#include <array>

#include "core/contact/constants.h"
#include "core/contact/distance.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// A capsule in the obstacle's frame at one instant; t runs from end a to end b.
struct Axis {
  const Obstacle& obstacle;
  Vec3 a, b;
  double ra, rb;

  Vec3 at(double t) const { return a + t * (b - a); }
  double radius(double t) const { return ra + t * (rb - ra); }
  double gap(double t) const { return signedDistanceValue(obstacle, at(t)) - radius(t); }
};

/// Whether a place is between the ends of its stick. What touches at an end is a particle.
inline bool isBetweenEnds(double t) { return t > kEndOfStick && t < 1 - kEndOfStick; }

/// [m] How far its ends move.
double travelOf(const Axis& start, const Axis& end);

/// Nearest place to the obstacle, in [0, 1].
double nearest(const Axis& axis);

/// Nearest place of its line, also beyond its ends by `beyond` of its length, to that face, edge or
/// corner of the obstacle's core that `feature` says: on which side (-1, 1) of each of its axes, 0
/// for beside it.
double nearestTo(const Axis& axis, const std::array<int, 3>& feature, double beyond);

/// How far the axis is over a face of a box from its nearest place `t` towards `end` (0 or 1), at
/// less than 10 degrees, or lies along an edge: all of it may come into touch at once. Across an
/// edge only t does: there the gap is small nearby only since the capsule is round. Where it runs
/// through the box, how far it is as deep.
double flatEnd(const Axis& axis, double t, double end);

/// Whether from its place `t` to `end` (0 or 1) the axis is beside one edge or corner of a box, or
/// beside what is round: there it is the nearer the nearer to t, by its roundness alone.
bool isRoundTo(const Axis& axis, double t, double end);

}  // namespace ragdoll
