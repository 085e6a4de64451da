// ~pause, ~step, ~reset.
#pragma once

#include <ragdoll_msgs/Step.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <vector>

#include "publisher.h"
#include "ragdoll_sim/world/simulation.h"

namespace ragdoll {

class Control {
 public:
  Control(ros::NodeHandle& nh, Simulation& simulation, Publisher& publisher);

 private:
  bool pause(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);
  bool step(ragdoll_msgs::Step::Request& request, ragdoll_msgs::Step::Response& response);
  bool reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);

  Simulation& simulation_;
  Publisher& publisher_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace ragdoll
