// Other nodes' TF frames. Never waits: a lookup answers from what has been heard so far, so that it
// cannot hang when no clock ticks.
#pragma once

#include <ros/callback_queue.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ragdoll_sim/core/types.h"

namespace ragdoll {

struct StampedPose {
  Pose pose;
  ros::Time stamp;  ///< of the latest news of it; 0: it never changes
};

class FrameLookup {
 public:
  explicit FrameLookup(const std::string& world_frame);
  ~FrameLookup();

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
  /// Until the end. tf2 throws at stamps near 2^32 s, which in its own thread would end the node.
  void listen();

  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  tf2_ros::Buffer buffer_;
  std::optional<tf2_ros::TransformListener> listener_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace ragdoll
