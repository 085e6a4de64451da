// The time that the node stamps with: ROS time, or with ~publish_clock the simulation's own, which
// it then publishes on /clock.
#pragma once

#include <ros/callback_queue.h>
#include <ros/message_event.h>
#include <ros/node_handle.h>
#include <ros/time.h>
#include <rosgraph_msgs/Clock.h>

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "ragdoll_sim/world/simulation.h"

namespace ragdoll {

class RosClock {
 public:
  /// own: the simulation's time is the clock. It begins at the wall time of this call, so that it
  /// is never 0 and goes on from what other nodes have seen; it stands still while the simulation
  /// does.
  explicit RosClock(bool own) : own_(own), begin_(ros::WallTime::now().toSec()) {}

  bool own() const { return own_; }
  ros::Time now(Simulation& simulation) const;
  ros::Time at(const Progress& progress) const;

 private:
  bool own_;
  double begin_;  ///< [s]
};

/// /clock, at most kRate times a second and never the same time twice. Hears who else publishes it:
/// time would jump between both.
class ClockPublisher {
 public:
  static constexpr double kRate = 100;  ///< [Hz]

  ClockPublisher(ros::NodeHandle& nh, Simulation& simulation, const RosClock& clock);
  ~ClockPublisher();

  /// Others that have ticked of late; the log tells each when it begins. Of one thread.
  std::vector<std::string> rivals();
  /// Whether no other is there, ticking or not.
  bool isAlone() const { return heard_.getNumPublishers() <= 1; }

 private:
  using Event = ros::MessageEvent<rosgraph_msgs::Clock const>;

  void run();
  void hear(const Event& event);

  Simulation& simulation_;
  const RosClock& clock_;
  ros::CallbackQueue queue_;  ///< what was heard, until rivals() looks
  ros::NodeHandle node_;
  ros::Publisher publisher_;
  ros::Subscriber heard_;
  std::map<std::string, ros::WallTime> rivals_;  ///< when each was heard last
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace ragdoll
