// The node's private parameters, read once and checked at start.
#pragma once

#include <ros/ros.h>

#include <string>

#include "settings.h"

namespace ragdoll {

struct Parameters {
  std::string scene = "stairs";  ///< name, path or package://PACKAGE/FILE
  std::string world_frame = "world";
  double publish_rate = 60;    ///< [Hz] in (0, 1000]
  double realtime_factor = 1;  ///< simulated time per clock time, > 0; -1: as fast as it goes
  bool start_paused = false;
  bool publish_clock = false;
  double wrench_timeout = 0.2;  ///< [s] in (0, 60]
  std::string coat;             ///< empty: what the scene says
  bool show_limits = false;     ///< draw the joints' limits
  bool show_contacts = false;   ///< draw contacts and their forces
  std::string frame_prefix;     ///< of the names of all frames that the node publishes
  double publish_every = 0;     ///< [s] of simulated time, in place of publish_rate; 0: that
  std::string tf_bodies;        ///< all, roots or none; empty: roots above kManyBodies
  double max_frame_speed = 5;   ///< [m/s] > 0; frames of others that move faster jump
};

/// Throws Error that names the parameter, its value and what would be right. Warns of parameters
/// that mean nothing to this node. Those that are settings, too, are as `given`.
Parameters readParameters(const ros::NodeHandle& nh, const GivenSettings& given);

/// "package://PACKAGE/FILE" as a path; anything else as it is. Throws Error for an unknown
/// package, or without a file.
std::string resolvePackage(const std::string& path);

}  // namespace ragdoll
