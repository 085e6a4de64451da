// How the simulation is doing, once a second: ~metrics for programs, /diagnostics for people.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ragdoll_msgs/Metrics.h>
#include <ros/node_handle.h>

#include <functional>
#include <string>
#include <vector>

#include "ragdoll_sim/world/simulation.h"

namespace ragdoll {

class Metrics {
 public:
  /// missing: frames that something follows and that TF does not give.
  Metrics(ros::NodeHandle& nh, std::function<std::vector<std::string>()> missing);

  /// Once a second, from what has happened since; else nothing.
  void publish(const Snapshot& world, const std_msgs::Header& header);

 private:
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);
  void measure(const Snapshot& world, double seconds);

  double wanted_factor_ = 1;
  std::function<std::vector<std::string>()> missing_;
  ros::Publisher publisher_;
  diagnostic_updater::Updater updater_;
  Simulation::Clock::time_point last_;
  Progress before_, since_;                ///< since_: over the last period
  std::vector<std::string> out_of_reach_;  ///< ragdolls beyond kFarthest (bounds.h)
  bool paused_ = false, was_paused_ = true;
  ragdoll_msgs::Metrics message_;
};

}  // namespace ragdoll
