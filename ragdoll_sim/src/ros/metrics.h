// How the simulation is doing, once a second: ~metrics for programs, /diagnostics for people.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ragdoll_msgs/Metrics.h>
#include <ros/node_handle.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ragdoll_sim/world/pace.h"
#include "ragdoll_sim/world/simulation.h"

namespace ragdoll {

/// What is wrong with TF and /clock.
struct Troubles {
  std::function<std::vector<std::string>()> missing;  ///< frames that something follows in vain
  std::function<std::vector<std::string>()> rivals;   ///< FrameLookup::rivals
  std::function<std::vector<std::string>()> clocks;   ///< ClockPublisher::rivals
};

class Metrics {
 public:
  Metrics(ros::NodeHandle& nh, Troubles troubles);

  /// Once a second, from what has happened since; else nothing.
  void publish(const Snapshot& world, const std_msgs::Header& header);

 private:
  void diagnoseClock(diagnostic_updater::DiagnosticStatusWrapper& status);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);
  void measure(const Snapshot& world, double seconds);

  double wanted_factor_ = 1;
  Troubles troubles_;
  ros::Publisher publisher_;
  diagnostic_updater::Updater updater_;
  Simulation::Clock::time_point last_;
  Progress before_, since_;  ///< since_: over the last period
  Pace pace_;
  std::vector<std::string> out_of_reach_;  ///< ragdolls beyond kFarthest (bounds.h)
  std::vector<std::string> overlaps_;      ///< world/findings.h
  bool paused_ = false, was_paused_ = true;
  std::optional<double> clock_silence_;  ///< as Snapshot has it
  ragdoll_msgs::Metrics message_;
};

}  // namespace ragdoll
