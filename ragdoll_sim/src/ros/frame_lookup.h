// Other nodes' TF frames. Never waits: a lookup answers from what has been heard so far, so that it
// cannot hang when no clock ticks.
//
// What comes on /tf, this node's own messages among it, lies in a queue until someone asks, or for
// kPeriod: to be woken by each message would cost more than all else here.
#pragma once

#include <ros/callback_queue.h>
#include <ros/message_event.h>
#include <ros/subscriber.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/buffer.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
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

  /// Latest known pose in the world frame of a frame of another node. Throws Error that names the
  /// frames there are: of other nodes, and `own`; or if the pose is not finite or farther out than
  /// kFarthest (bounds.h).
  Pose inWorld(const std::string& frame, const Names& own = nullptr) const;

  /// Frames that other nodes publish, in alphabetic order.
  std::vector<std::string> others() const;

  /// "/other publishes ragdoll/pelvis, too": others that have published frames of this node's own
  /// of late.
  std::vector<std::string> rivals() const;

  /// As inWorld(); nothing where that throws.
  std::optional<StampedPose> find(const std::string& frame) const;

  /// As tf2 wants them: without a leading slash.
  static std::string normal(const std::string& frame);

 private:
  using Event = ros::MessageEvent<tf2_msgs::TFMessage const>;

  void run();           ///< hears now and then, until the end
  void listen() const;  ///< hears all that has come; who asks at the same time waits for it
  void hear(const Event& event, bool is_static);
  void hearOwn(const tf2_msgs::TFMessage& message);
  /// What this node has published since the last look: of others' frames some may hang on its own.
  void takeOwn() const;
  /// False if the buffer does not take it.
  bool take(const geometry_msgs::TransformStamped& transform, const std::string& publisher,
            bool is_static) const;
  void forget();
  void claim(const std::string& frame, const std::string& publisher, bool other);
  bool isOthers(const std::string& frame) const;

  std::string world_frame_;
  mutable ros::CallbackQueue queue_;
  mutable std::mutex hearing_;  ///< before mutex_
  ros::NodeHandle node_;
  mutable tf2_ros::Buffer buffer_;
  ros::Subscriber moving_, static_;
  ros::Time last_heard_;
  mutable std::mutex mutex_;
  struct Link {
    std::string parent, child;
  };
  /// A message of this node's own; names are shared by all that have the same. Whole messages would
  /// be 2 MB for a body, and each new one would be made in memory that no cache has.
  struct OwnFrames {
    ros::Time stamp;
    std::shared_ptr<const std::vector<Link>> links;
    std::vector<geometry_msgs::Transform> transforms;
  };
  mutable std::deque<OwnFrames> own_;  ///< heard of this node, and not in the buffer yet
  std::shared_ptr<const std::vector<Link>> own_links_;  ///< of the last
  ros::WallTime claimed_;  ///< when its frames were last known as its own
  struct Owner {
    bool other = false;  ///< it was another node's when it was heard last
    ros::WallTime own;   ///< when this node published it last; 0: never
  };
  std::map<std::string, Owner> owners_;
  struct Claim {
    std::string frame;
    ros::WallTime at;
  };
  std::map<std::string, Claim> claims_;  ///< by node: an own frame that it published
  std::mutex end_mutex_;
  std::condition_variable end_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace ragdoll
