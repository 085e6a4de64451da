// The scene's virtual IMUs on their topics, ~imu/<ragdoll>/<name>.
#pragma once

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

 private:
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
  Moment last_;
};

}  // namespace ragdoll
