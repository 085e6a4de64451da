#include "ros_clock.h"

#include <rosgraph_msgs/Clock.h>

namespace ragdoll {

ros::Time RosClock::now(Simulation& simulation) const {
  return own_ ? at(simulation.progress()) : ros::Time::now();
}

ros::Time RosClock::at(const Progress& progress) const {
  return own_ ? ros::Time(begin_ + progress.simulated) : ros::Time::now();
}

ClockPublisher::ClockPublisher(ros::NodeHandle& nh, Simulation& simulation, const RosClock& clock)
    : simulation_(simulation), clock_(clock) {
  publisher_ = nh.advertise<rosgraph_msgs::Clock>("/clock", 10);
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
