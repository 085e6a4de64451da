#include "pokes.h"

#include <ros/this_node.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "answer.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/ros/convert.h"
#include "ragdoll_sim/world/text.h"
#include "ragdoll_sim/world/wrench.h"

namespace ragdoll {
namespace {

constexpr double kBadStreamPeriod = 1;  ///< [s] a stream that is wrong is reported this often

/// [s] exact, and without the overflow of ros::Duration at 2^31 s.
double since(const ros::Time& time, const ros::Time& other) {
  return static_cast<double>(static_cast<std::int64_t>(time.toNSec()) -
                             static_cast<std::int64_t>(other.toNSec())) *
         1e-9;
}

/// How long a poke acts, as World rounds it: so that 1 for 1 s, which is 1 ns, is seen.
std::string length(double duration, double step) {
  if (duration < 0) return " until cleared";
  const double steps = std::max(1.0, std::round(duration / step));
  return " for " + counted(static_cast<std::uint64_t>(steps), "step");
}

}  // namespace

Pokes::Pokes(ros::NodeHandle& nh, Simulation& simulation, const RosClock& clock,
             const FrameLookup& frames, double wrench_timeout)
    : simulation_(simulation), clock_(clock), frames_(frames), wrench_timeout_(wrench_timeout) {
  servers_.push_back(nh.advertiseService("poke", &Pokes::poke, this));
  servers_.push_back(nh.advertiseService("clear_pokes", &Pokes::clear, this));
  subscribers_.push_back(nh.subscribe("wrench", 10, &Pokes::wrench, this));
  subscribers_.push_back(nh.subscribe("poke_replay", 1000, &Pokes::replay, this));
}

bool Pokes::poke(ragdoll_msgs::Poke::Request& request, ragdoll_msgs::Poke::Response& response) {
  return answer([&] { return accept(request); }, response.success, response.status_message);
}

std::string Pokes::accept(const ragdoll_msgs::Poke::Request& request) {
  const Vec3 force = fromVector3(request.force), point = fromPoint(request.reference_point);
  const std::string frame = FrameLookup::normal(request.reference_frame);
  const ros::Time now = clock_.now(simulation_);
  const double delay = std::max(0.0, since(request.start_time, now)) * simulatedPerClock();

  return simulation_.call([&](World& world) {
    Poke poke;
    poke.body = findBody(*world.model(), request.body_name);
    poke.body_name = fullName(*world.model(), poke.body, request.body_name);
    checkFinite(force, "force", "[N]");
    checkFinite(point, "reference_point", "[m]");
    const std::optional<Pose> own = world.frame(frame);
    const auto own_frames = [&] { return world.frameNames(); };
    const Quat q_WF = own ? own->orientation : frames_.inWorld(frame, own_frames).orientation;
    poke.force = q_WF * force;
    poke.point = q_WF * point;
    poke.start = world.state().time + delay;
    poke.duration = request.duration.toSec();
    const std::string what =
        poke.body_name + ": " + shown(poke.force) + " N in " + frames_.worldFrame() + " from step ";
    const std::string lost = lostMomentText(poke, world.state().x);
    const std::string end =
        length(poke.duration, world.stepLength()) + (lost.empty() ? "" : "; " + lost);
    return what + std::to_string(world.addPoke(std::move(poke))) + end;
  });
}

/// [s/s] how fast simulated time goes by the clock that requests are stamped with.
double Pokes::simulatedPerClock() const {
  if (clock_.own() || simulation_.realtimeFactor() < 0) return 1;
  return simulation_.realtimeFactor();
}

bool Pokes::clear(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  const auto act = [&] {
    const std::size_t n = simulation_.call([](World& world) { return world.clearPokes(); });
    return counted(n, "poke") + " ended";
  };
  return answer(act, response.success, response.message);
}

void Pokes::wrench(const geometry_msgs::WrenchStamped& message) {
  const std::string frame = FrameLookup::normal(message.header.frame_id);
  const Vec3 force = fromVector3(message.wrench.force), torque = fromVector3(message.wrench.torque);
  try {
    checkFinite(force, "force", "[N]");
    checkFinite(torque, "torque", "[N m]");
    const double seconds = wrench_timeout_ * simulatedPerClock();
    simulation_.call([&](World& world) {
      world.stream(frame, wrenchPokes(world, frame, force, torque), seconds);
    });
  } catch (const Error& e) {
    ROS_WARN_THROTTLE(kBadStreamPeriod, "~wrench ignored: %s", e.what());
  }
}

void Pokes::replay(const ros::MessageEvent<ragdoll_msgs::PokeEvent const>& message) {
  if (message.getPublisherName() == ros::this_node::getName()) return;  // ~pokes fed back to itself
  const ragdoll_msgs::PokeEvent& m = *message.getConstMessage();
  try {
    simulation_.call([&](World& world) { world.replay(fromPokeEvent(*world.model(), m)); });
  } catch (const Error& e) {
    ROS_WARN("~poke_replay ignored: %s", e.what());
  }
}

}  // namespace ragdoll
