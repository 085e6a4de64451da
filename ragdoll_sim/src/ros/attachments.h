// ~attach and ~detach, and the frames of others that pins and obstacles follow: a thread of its own
// looks them up in TF and tells the world.
#pragma once

#include <ragdoll_msgs/Attach.h>
#include <ragdoll_msgs/Detach.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "frame_lookup.h"
#include "ragdoll_sim/world/simulation.h"
#include "ros_clock.h"

namespace ragdoll {

class Attachments {
 public:
  Attachments(ros::NodeHandle& nh, Simulation& simulation, const RosClock& clock,
              const FrameLookup& frames);
  ~Attachments();

  /// Frames that are wanted but have never been heard, or not for kSilence: what carries them
  /// stands.
  std::vector<std::string> missing() const;

 private:
  struct Heard {
    ros::Time stamp;
    std::optional<double> at;  ///< [s] of passed_, when the stamp was new
    bool ever = false;
    bool missing = false;  ///< too long without news
    bool unknown = false;  ///< it was missing before it was ever heard
  };

  bool attach(ragdoll_msgs::Attach::Request& request, ragdoll_msgs::Attach::Response& response);
  bool detach(ragdoll_msgs::Detach::Request& request, ragdoll_msgs::Detach::Response& response);
  void run();
  void look();
  void letTimePass();
  void judge(const std::string& frame, Heard& heard);

  Simulation& simulation_;
  const RosClock& clock_;
  const FrameLookup& frames_;
  double passed_ = 0;  ///< [s] in which frames could have been heard; of run() alone
  Simulation::Clock::time_point ticked_;  ///< when the clock was seen to tick last
  double tick_ = 0;                       ///< [s] what it said then
  std::vector<ros::ServiceServer> servers_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::string, Heard> heard_;
  bool stopping_ = false;
  bool follows_ = false;  ///< the world follows frames
  std::thread thread_;    // last
};

}  // namespace ragdoll
