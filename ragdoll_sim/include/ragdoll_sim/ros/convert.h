// Between the core's types and messages: the only place that knows both.
#pragma once

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Quaternion.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/Vector3.h>
#include <ragdoll_msgs/FollowedFrame.h>
#include <ragdoll_msgs/Model.h>
#include <ragdoll_msgs/PokeEvent.h>
#include <ragdoll_msgs/State.h>
#include <std_msgs/Header.h>
#include <visualization_msgs/Marker.h>

#include <string>
#include <vector>

#include "ragdoll_sim/body/coat.h"
#include "ragdoll_sim/body/frames.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/scene.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/world/world.h"

namespace ragdoll {

std_msgs::Header toHeader(const std::string& frame, const ros::Time& stamp);
geometry_msgs::Point toPoint(const Vec3& v);
geometry_msgs::Vector3 toVector3(const Vec3& v);
geometry_msgs::Quaternion toQuaternion(const Quat& q);
geometry_msgs::Pose toPose(const Pose& pose);
geometry_msgs::Transform toTransform(const Pose& pose);
std_msgs::ColorRGBA toColor(const Rgba& color);

Vec3 fromPoint(const geometry_msgs::Point& p);
Vec3 fromVector3(const geometry_msgs::Vector3& v);
Pose fromTransform(const geometry_msgs::Transform& t);

ragdoll_msgs::Model toModelMsg(const Scene& scene, const Model& model,
                               const std_msgs::Header& header);
ragdoll_msgs::State toStateMsg(const Model& model, const State& state, const RunMark& mark,
                               const std_msgs::Header& header);

/// Whether it is of this model's bodies, in numbers that are finite.
bool fits(const Model& model, const ragdoll_msgs::State& message);
/// Step, time and positions; velocities stay. REQUIRES: fits().
void putState(const Model& model, const ragdoll_msgs::State& message, State& state);

ragdoll_msgs::PokeEvent toPokeEvent(const Event& event, const std_msgs::Header& header);

/// The poke's start is for World::replay to set. Throws Error for a body that the model does not
/// know, and for numbers that are not finite.
Event fromPokeEvent(const Model& model, const ragdoll_msgs::PokeEvent& message);

ragdoll_msgs::FollowedFrame toFollowedMsg(const FollowedFrame& followed,
                                          const std_msgs::Header& header);

/// Throws Error for a particle that the model does not know, and for numbers that are no glide.
FollowedFrame fromFollowedMsg(const Model& model, const ragdoll_msgs::FollowedFrame& message);

/// All frames of all ragdolls, each in its parent; the roots in header.frame_id.
std::vector<geometry_msgs::TransformStamped> toTransforms(const FrameTracker& tracker,
                                                          const Posture& posture,
                                                          const std_msgs::Header& header,
                                                          bool roots_only = false);

/// Fills type, pose, scale, colours and points.
void toMarker(const CoatShape& shape, visualization_msgs::Marker& marker);

}  // namespace ragdoll
