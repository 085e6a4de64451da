// The time that the node stamps with: ROS time, or with ~publish_clock the simulation's own, which
// it then publishes on /clock.
#pragma once

#include <ros/node_handle.h>
#include <ros/time.h>

#include <memory>
#include <mutex>
#include <thread>

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

/// /clock, at most kRate times a second and never the same time twice.
class ClockPublisher {
 public:
  static constexpr double kRate = 100;  ///< [Hz]

  ClockPublisher(ros::NodeHandle& nh, Simulation& simulation, const RosClock& clock);
  ~ClockPublisher();

 private:
  void run();

  Simulation& simulation_;
  const RosClock& clock_;
  ros::Publisher publisher_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace ragdoll
