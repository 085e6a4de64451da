// ~largest_contact: four times a second the contact that pressed hardest since the last message,
// for who shows one line of it.
#pragma once

#include <ros/node_handle.h>

#include <cstdint>
#include <vector>

#include "outbox.h"
#include "ragdoll_sim/world/simulation.h"
#include "topic.h"

namespace ragdoll {

class LargestContact {
 public:
  explicit LargestContact(ros::NodeHandle& nh);

  /// Whether anyone listens.
  bool wanted() const { return topic_.isHeard(); }

  /// With each snapshot; a message when one is due and steps were made.
  void publish(const Snapshot& world, const std_msgs::Header& header, Outbox& out);

 private:
  using Clock = Simulation::Clock;

  void hear(const Snapshot& world);
  void clear();

  Topic topic_;
  std::vector<Touch> touches_;  ///< since the last message
  double interval_ = 0;         ///< [s] that they are of
  std::uint32_t run_ = 0;       ///< the same
  Clock::time_point due_;
};

}  // namespace ragdoll
