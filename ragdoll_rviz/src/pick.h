// Which body a line of sight meets. All in the world frame of the simulation.
#pragma once

#include <ragdoll_msgs/Model.h>
#include <ragdoll_msgs/State.h>

#include <Eigen/Core>
#include <optional>
#include <string>

namespace ragdoll_rviz {

struct Ray {
  Eigen::Vector3d origin;     ///< [m]
  Eigen::Vector3d direction;  ///< unit
};

/// What ~poke wants to know.
struct Hit {
  std::string body_name;   ///< "ragdoll/left_forearm": a bone, or a particle of what is no bone
  Eigen::Vector3d offset;  ///< [m] of the point that is met from the body's own point
  double depth;            ///< [m] along the ray
};

/// [m] Distance from a stick at which a ray is taken to meet it: limbs are this thick.
constexpr double kLimbRadius = 0.06;
/// [m] The same where no limb is met: the torso and the head are this thick.
constexpr double kTrunkRadius = 0.13;

/// The nearest stick, or lone particle, on the ray; nothing if it passes by all. Model and state
/// may belong to different moments: what is only in one of them is not met.
std::optional<Hit> pick(const Ray& ray, const ragdoll_msgs::Model& model,
                        const ragdoll_msgs::State& state);

}  // namespace ragdoll_rviz
