// Basic types of the core. Points are columns; units are SI; the frame is the world (z up, REP-103)
// unless a name says otherwise.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace ragdoll {

using Vec3 = Eigen::Vector3d;
using Quat = Eigen::Quaterniond;
using Points = Eigen::Matrix3Xd;  ///< one column per particle [m] (or [m/s], [N])

struct Pose {
  Vec3 position = Vec3::Zero();         ///< [m] origin of the frame in the world
  Quat orientation = Quat::Identity();  ///< frame -> world
};

constexpr double kMinLength = 1e-9;  ///< [m] below this a stick or a bone has no direction

}  // namespace ragdoll
