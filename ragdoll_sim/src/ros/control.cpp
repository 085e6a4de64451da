#include "control.h"

#include "answer.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

constexpr std::uint32_t kMaxSteps = 10000000;  ///< in one call of ~step: more is a typing error

}  // namespace

Control::Control(ros::NodeHandle& nh, Simulation& simulation, Publisher& publisher)
    : simulation_(simulation), publisher_(publisher) {
  servers_.push_back(nh.advertiseService("pause", &Control::pause, this));
  servers_.push_back(nh.advertiseService("step", &Control::step, this));
  servers_.push_back(nh.advertiseService("reset", &Control::reset, this));
}

bool Control::pause(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
  const auto act = [&] {
    simulation_.setPaused(request.data);
    return std::string(request.data ? "paused" : "running");
  };
  return answer(act, response.success, response.message);
}

bool Control::step(ragdoll_msgs::Step::Request& request, ragdoll_msgs::Step::Response& response) {
  const auto act = [&] {
    if (request.steps > kMaxSteps)
      throw Error("steps", "is " + std::to_string(request.steps) + "; at most " +
                               std::to_string(kMaxSteps) + " at a time");
    if (!simulation_.paused()) throw Error("", "not paused; pause first: ~pause with data: true");
    response.step = simulation_.step(request.steps);
    publisher_.publishNow();
    return "at step " + std::to_string(response.step);
  };
  return answer(act, response.success, response.status_message);
}

bool Control::reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  const auto act = [&] {
    simulation_.jump([](World& world) { world.reset(); });
    publisher_.publishNow();
    return std::string("at the scene's start");
  };
  return answer(act, response.success, response.message);
}

}  // namespace ragdoll
