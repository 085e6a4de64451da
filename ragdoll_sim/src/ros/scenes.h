// ~load_scene, ~get_state, ~set_state: what replaces or keeps the whole world.
#pragma once

#include <ragdoll_msgs/GetState.h>
#include <ragdoll_msgs/LoadScene.h>
#include <ragdoll_msgs/SetState.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <functional>
#include <string>
#include <vector>

#include "parameters.h"
#include "publisher.h"
#include "ragdoll_sim/world/simulation.h"
#include "ros_clock.h"

namespace ragdoll {

/// What the checks at load found, and what stands in each other there.
std::vector<std::string> startWarnings(const World& world);

/// To the log: startWarnings, which bodies are trees, and what was decided
/// (Model::notes) but for what was `told` already.
void tellChecks(const World& world, const std::vector<std::string>& told = {});

/// Throws Error if a frame that the node publishes for it is the world frame: TF would have a loop.
void checkWorldFrame(const std::string& where, const World& world, const Parameters& parameters);

class Scenes {
 public:
  /// changed: called when the settings of the solver may be others.
  Scenes(ros::NodeHandle& nh, Simulation& simulation, Publisher& publisher, const RosClock& clock,
         const Parameters& parameters, std::function<void()> changed);

 private:
  bool load(ragdoll_msgs::LoadScene::Request& request, ragdoll_msgs::LoadScene::Response& response);
  bool get(ragdoll_msgs::GetState::Request&, ragdoll_msgs::GetState::Response& response);
  bool set(ragdoll_msgs::SetState::Request& request, ragdoll_msgs::SetState::Response& response);

  Simulation& simulation_;
  Publisher& publisher_;
  const RosClock& clock_;
  const Parameters parameters_;
  std::function<void()> changed_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace ragdoll
