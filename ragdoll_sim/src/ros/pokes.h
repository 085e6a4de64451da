// Forces from others: ~poke, ~clear_pokes, ~wrench (a stream) and ~poke_replay (recorded ones).
#pragma once

#include <geometry_msgs/WrenchStamped.h>
#include <ragdoll_msgs/Poke.h>
#include <ragdoll_msgs/PokeEvent.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/subscriber.h>
#include <std_srvs/Trigger.h>

#include <vector>

#include "frame_lookup.h"
#include "ragdoll_sim/world/simulation.h"
#include "ros_clock.h"

namespace ragdoll {

class Pokes {
 public:
  Pokes(ros::NodeHandle& nh, Simulation& simulation, const RosClock& clock,
        const FrameLookup& frames, double wrench_timeout);

 private:
  bool poke(ragdoll_msgs::Poke::Request& request, ragdoll_msgs::Poke::Response& response);
  bool clear(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  void wrench(const geometry_msgs::WrenchStamped& message);
  void replay(const ros::MessageEvent<ragdoll_msgs::PokeEvent const>& event);

  std::string accept(const ragdoll_msgs::Poke::Request& request);
  double simulatedPerClock() const;

  Simulation& simulation_;
  const RosClock& clock_;
  const FrameLookup& frames_;
  double wrench_timeout_;
  std::vector<ros::ServiceServer> servers_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace ragdoll
