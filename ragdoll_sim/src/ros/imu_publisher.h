// The scene's virtual IMUs on their topics, ~imu/<ragdoll>/<name>, and as frames.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <ros/node_handle.h>

#include <memory>
#include <string>
#include <vector>

#include "ragdoll_sim/world/snapshot.h"

namespace ragdoll {

class ImuPublisher {
 public:
  ImuPublisher(ros::NodeHandle& nh, std::string frame_prefix);

  /// All samples since the last snapshot; `now` is the time of its state.
  void publish(const Snapshot& world, const ros::Time& now);

  /// The sensors' frames, each in the frame of the body that it turns with; whole: else in the
  /// world, as the bodies' own frames are not there. header: of the world frame.
  void appendTransforms(const Snapshot& world, const Posture& posture, bool whole,
                        const std_msgs::Header& header,
                        std::vector<geometry_msgs::TransformStamped>& out);

 private:
  struct Mount {
    int frame = -1;  ///< of the tracker
    Pose local;      ///< of the sensor in it
  };
  /// What was told last: [s] of all that was simulated, and its stamp.
  struct Moment {
    double simulated = 0;
    ros::Time stamp;
  };
  void follow(const Snapshot& world);
  ros::Time stampOf(const Snapshot& world, double time, const ros::Time& now) const;

  ros::NodeHandle nh_;
  std::string frame_prefix_;
  std::shared_ptr<const Scene> scene_;
  std::vector<ros::Publisher> topics_;  ///< of the scene's sensors
  std::vector<Mount> mounts_;
  Moment last_;
};

}  // namespace ragdoll
