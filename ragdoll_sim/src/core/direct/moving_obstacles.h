// Obstacles that move, over a part of a step: evenly from where they are at its start to where they
// are at its end.
#pragma once

#include <vector>

#include "core/contact/detect.h"
#include "core/direct/body.h"

namespace ragdoll {

/// Share 0 ... 1 of the way from a to b, exact at both.
Pose between(const Pose& a, const Pose& b, double share);

/// The obstacles over h [s] from the beginning of the body's present trial on. Valid until the
/// thread's next call.
const std::vector<SweptObstacle>& obstaclesOver(const Body& body, double h);

/// An obstacle at an instant, and how it moves: evenly, and it turns about its own point.
struct ObstacleMotion {
  const Obstacle* obstacle = nullptr;
  bool moves = false;
  Eigen::Matrix3d R;          ///< frame -> world
  Vec3 p;                     ///< [m] of its own point
  Vec3 speed = Vec3::Zero();  ///< [m/s] likewise
  Vec3 spin = Vec3::Zero();   ///< [rad/s]

  Vec3 toFrame(const Vec3& x) const { return R.transpose() * (x - p); }
  /// [m/s] Of what is fixed to it, at x.
  Vec3 velocityAt(const Vec3& x) const { return speed + spin.cross(x - p); }
};

/// The obstacle at a time [s] since the beginning of its motion, which takes h.
ObstacleMotion motionAt(const SweptObstacle& swept, double time, double h);

/// [m/s] Of the fastest, as they are at the beginning, where the body's particles are.
double fastestObstacle(const Body& body);

/// Of a contact found with these: its motion in the part becomes that of a whole step.
void scaleMotion(const StepContext& step, double h, Contact& contact);

}  // namespace ragdoll
