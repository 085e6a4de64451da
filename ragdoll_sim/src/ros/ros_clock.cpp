#include "ros_clock.h"

#include <ros/console.h>
#include <ros/this_node.h>

namespace ragdoll {
namespace {

constexpr double kClockRivalry = 5;  ///< [s] without a tick of the other's, then it is over
constexpr int kTicksKept = 1000;     ///< of all, between two looks

}  // namespace

ros::Time RosClock::now(Simulation& simulation) const {
  return own_ ? at(simulation.progress()) : ros::Time::now();
}

ros::Time RosClock::at(const Progress& progress) const {
  return own_ ? ros::Time(begin_ + progress.simulated) : ros::Time::now();
}

ClockPublisher::ClockPublisher(ros::NodeHandle& nh, Simulation& simulation, const RosClock& clock)
    : simulation_(simulation), clock_(clock) {
  publisher_ = nh.advertise<rosgraph_msgs::Clock>("/clock", 10);
  node_.setCallbackQueue(&queue_);
  heard_ = node_.subscribe<rosgraph_msgs::Clock, const Event&>(
      "/clock", kTicksKept,
      boost::function<void(const Event&)>([this](const Event& event) { hear(event); }));
  thread_ = std::thread([this] { run(); });
}

ClockPublisher::~ClockPublisher() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

std::vector<std::string> ClockPublisher::rivals() {
  queue_.callAvailable();
  std::vector<std::string> names;
  for (const auto& [name, at] : rivals_)
    if ((ros::WallTime::now() - at).toSec() < kClockRivalry) names.push_back(name);
  return names;
}

void ClockPublisher::hear(const Event& event) {
  const std::string name = event.getPublisherName();
  if (name == ros::this_node::getName()) return;
  const ros::WallTime now = ros::WallTime::now();
  ros::WallTime& at = rivals_[name];
  if (at.isZero() || (now - at).toSec() > kClockRivalry)
    ROS_WARN(
        "%s publishes /clock, which this node publishes, too: time jumps between both; end one of "
        "them, or start it without ~publish_clock",
        name.c_str());
  at = now;
}

void ClockPublisher::run() {
  const auto period = std::chrono::duration_cast<Simulation::Clock::duration>(
      std::chrono::duration<double>(1 / kRate));
  ros::Time last;
  std::unique_lock<std::mutex> lock(mutex_);
  while (!wake_.wait_for(lock, period, [this] { return stopping_; })) {
    rosgraph_msgs::Clock message;
    try {
      message.clock = clock_.now(simulation_);
    } catch (const Error&) {
      return;  // the simulation has ended
    }
    if (message.clock == last) continue;
    last = message.clock;
    publisher_.publish(message);
  }
}

}  // namespace ragdoll
