// Signed distance from a point to an obstacle, in the obstacle's own frame. Convex bodies: the
// distance is a convex, 1-Lipschitz function, which is what the sweep in detect.cpp relies on.
#pragma once

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

struct Distance {
  double value = 0;  ///< [m] negative inside
  Vec3 normal;       ///< unit, out of the obstacle; a fixed direction where it is undefined
};

/// p: [m] in the obstacle's frame (plane: z is the normal; capsule: z is the axis).
Distance signedDistance(const Obstacle& obstacle, const Vec3& p);

/// The same of an endless line through p along a unit vector: how far it is from leaving the core's
/// solid across itself by the shortest way. Not for planes.
Distance lineDistance(const Obstacle& obstacle, const Vec3& p, const Vec3& along);

/// The value alone, for searches.
double signedDistanceValue(const Obstacle& obstacle, const Vec3& p);

}  // namespace ragdoll
