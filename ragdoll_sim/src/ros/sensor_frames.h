// The scene's sensors as TF frames.
#pragma once

#include <geometry_msgs/TransformStamped.h>

#include <memory>
#include <string>
#include <vector>

#include "ragdoll_sim/world/imu.h"
#include "ragdoll_sim/world/snapshot.h"

namespace ragdoll {

class SensorFrames {
 public:
  explicit SensorFrames(std::string frame_prefix);

  /// Each in the frame of the body that it turns with; whole: else in the world, as the bodies' own
  /// frames are not there. header: of the world frame.
  void append(const Snapshot& world, const Posture& posture, bool whole,
              const std_msgs::Header& header, std::vector<geometry_msgs::TransformStamped>& out);

 private:
  std::string frame_prefix_;
  std::shared_ptr<const Scene> scene_;
  std::vector<SensorFrame> mounts_;  ///< of the scene's sensors
};

}  // namespace ragdoll
