// Other nodes' TF frames. Never waits: a lookup answers from what has been heard so far, so that it
// cannot hang when no clock ticks.
#pragma once

#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ragdoll_sim/core/types.h"

namespace ragdoll {

struct StampedPose {
  Pose pose;
  ros::Time stamp;  ///< of the latest news of it; 0: it never changes
};

class FrameLookup {
 public:
  explicit FrameLookup(const std::string& world_frame) : world_frame_(world_frame) {}

  using Names = std::function<std::vector<std::string>()>;

  const std::string& worldFrame() const { return world_frame_; }
  bool isWorld(const std::string& frame) const;

  /// Latest known pose in the world frame. Throws Error that names the frames there are: of other
  /// nodes, and `own`; or if the pose is not finite.
  Pose inWorld(const std::string& frame, const Names& own = nullptr) const;

  /// Frames that other nodes publish, in alphabetic order.
  std::vector<std::string> others() const;

  /// As inWorld(); nothing where there is none, or none that is finite.
  std::optional<StampedPose> find(const std::string& frame) const;

  /// As tf2 wants them: without a leading slash.
  static std::string normal(const std::string& frame);

 private:
  std::string world_frame_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_{buffer_};
};

}  // namespace ragdoll
