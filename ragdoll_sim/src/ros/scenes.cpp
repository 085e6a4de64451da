#include "scenes.h"

#include <ros/console.h>

#include "answer.h"
#include "parameters.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/findings.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/self_pairs.h"
#include "ragdoll_sim/core/trees.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/ros/convert.h"
#include "ragdoll_sim/world/text.h"

namespace ragdoll {
namespace {

World loadWorld(const ragdoll_msgs::LoadScene::Request& request, const std::string& prefix) {
  if (request.path.empty() == request.yaml.empty())
    throw Error("", std::string(request.path.empty() ? "neither" : "both") +
                        " of path and yaml given; it must be exactly one");
  return World(request.path.empty() ? parseScene(request.yaml, "yaml")
                                    : loadScene(resolvePackage(request.path)),
               request.path, prefix);
}

}  // namespace

std::vector<std::string> startWarnings(const World& world) {
  std::vector<std::string> warnings = world.model()->warnings;
  for (const std::string& overlap : deepOverlaps(*world.model(), world.state()))
    warnings.push_back(overlap + " at the start");
  const std::string taken = takenText(world.energyTaken());
  if (!taken.empty()) warnings.push_back(taken);
  return warnings;
}

void tellChecks(const World& world, const std::vector<std::string>& told) {
  for (const std::string& warning : startWarnings(world)) ROS_WARN("%s", warning.c_str());
  for (const TreeFinding& tree : findTrees(*world.model())) ROS_INFO("%s", describe(tree).c_str());
  for (const std::string& note : world.model()->notes)
    if (indexOf(told, note) < 0)
      ROS_INFO("%s%s", inShort(note).c_str(),
               inShort(note) == note ? "" : " (ragdoll_lab run SCENE --pairs lists them)");
}

void checkWorldFrame(const std::string& where, const World& world, const Parameters& parameters) {
  std::vector<std::string> own = world.frameNames();
  for (const Sensor& sensor : world.model()->sensors)
    own.push_back(parameters.frame_prefix + sensor.name);
  if (indexOf(own, parameters.world_frame) >= 0)
    throw Error(where, "is " + parameters.world_frame +
                           ", a frame of this scene's; it must be none of the node's own");
}

Scenes::Scenes(ros::NodeHandle& nh, Simulation& simulation, Publisher& publisher,
               const RosClock& clock, const Parameters& parameters, std::function<void()> changed)
    : simulation_(simulation),
      publisher_(publisher),
      clock_(clock),
      parameters_(parameters),
      changed_(std::move(changed)) {
  servers_.push_back(nh.advertiseService("load_scene", &Scenes::load, this));
  servers_.push_back(nh.advertiseService("get_state", &Scenes::get, this));
  servers_.push_back(nh.advertiseService("set_state", &Scenes::set, this));
}

bool Scenes::load(ragdoll_msgs::LoadScene::Request& request,
                  ragdoll_msgs::LoadScene::Response& response) {
  const auto act = [&] {
    // In this thread: the old scene goes on meanwhile.
    World next = loadWorld(request, parameters_.frame_prefix);
    checkWorldFrame("~world_frame", next, parameters_);
    std::string message = contents(*next.model());
    for (const std::string& warning : startWarnings(next)) message += "; " + warning;
    tellChecks(next, simulation_.call([](World& world) { return world.model()->notes; }));
    simulation_.jump([&](World& world) { world.replaceBy(next); });
    changed_();
    publisher_.publishNow();
    return message;
  };
  return answer(act, response.success, response.status_message);
}

bool Scenes::get(ragdoll_msgs::GetState::Request&, ragdoll_msgs::GetState::Response& response) {
  const ros::Time now = clock_.now(simulation_);
  simulation_.call([&](World& world) {
    response.state = toStateMsg(*world.model(), world.state(), world.mark(),
                                toHeader(parameters_.world_frame, now));
    response.snapshot = world.save();
  });
  return true;
}

bool Scenes::set(ragdoll_msgs::SetState::Request& request,
                 ragdoll_msgs::SetState::Response& response) {
  const auto act = [&] {
    std::uint64_t step = 0;
    simulation_.jump([&](World& world) {
      world.restore(request.snapshot);
      step = world.state().step;
    });
    changed_();
    publisher_.publishNow();
    return "at step " + std::to_string(step);
  };
  return answer(act, response.success, response.status_message);
}

}  // namespace ragdoll
