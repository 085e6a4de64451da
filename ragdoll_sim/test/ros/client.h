// What the C++ rostests share: the node's messages in order, waiting for conditions.
#pragma once

#include <ragdoll_msgs/State.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace ragdoll_test {

/// [s] A test that waits longer than this has failed.
inline double limit() { return std::getenv("RAGDOLL_SANITIZED") ? 300 : 30; }

/// False if the condition did not come true in time.
inline bool waitFor(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit());
  while (std::chrono::steady_clock::now() < end) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

/// Over a connection that stays: where each call has its own, roscpp now and then loses the answer
/// as the server hangs up (https://github.com/ros/ros_comm/issues/1976).
template <class Service>
bool call(const std::string& name, Service& service) {
  static std::mutex mutex;
  static auto& clients = *new std::map<std::string, ros::ServiceClient>;  // they outlive ROS
  ros::ServiceClient client;
  {
    std::lock_guard<std::mutex> lock(mutex);
    ros::ServiceClient& known = clients[name];
    if (!known.isValid()) known = ros::NodeHandle().serviceClient<Service>(name, true);
    client = known;
  }
  return client.call(service);
}

/// False if it is refused.
inline bool pause(bool data) {
  std_srvs::SetBool request;
  request.request.data = data;
  return call("/ragdoll/pause", request) && request.response.success;
}

inline bool reset() {
  std_srvs::Trigger request;
  return call("/ragdoll/reset", request) && request.response.success;
}

/// The bytes of everything that is physics.
inline std::string bits(const ragdoll_msgs::State& state) {
  std::string out(reinterpret_cast<const char*>(&state.step), sizeof state.step);
  const auto add = [&](double v) { out.append(reinterpret_cast<const char*>(&v), sizeof v); };
  add(state.time);
  for (const auto& r : state.ragdolls) {
    for (const auto& p : r.positions) add(p.x), add(p.y), add(p.z);
    for (const auto& v : r.velocities) add(v.x), add(v.y), add(v.z);
  }
  return out;
}

/// All messages of a topic, in order. Needs a spinner.
template <class Message>
class Inbox {
 public:
  using Ptr = boost::shared_ptr<Message const>;

  explicit Inbox(const std::string& topic) {
    subscriber_ = ros::NodeHandle().subscribe<Message>(topic, 10000, [this](const Ptr& m) {
      std::lock_guard<std::mutex> lock(mutex_);
      messages_.push_back(m);
    });
  }
  ~Inbox() { subscriber_.shutdown(); }

  bool connected() const {
    return waitFor([this] { return subscriber_.getNumPublishers() > 0; });
  }
  std::vector<Ptr> all() const {
    std::lock_guard<std::mutex> lock(mutex_);
    return messages_;
  }
  std::size_t size() const {
    std::lock_guard<std::mutex> lock(mutex_);
    return messages_.size();
  }
  /// Null before the first.
  Ptr last() const {
    std::lock_guard<std::mutex> lock(mutex_);
    return messages_.empty() ? nullptr : messages_.back();
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Ptr> messages_;
  ros::Subscriber subscriber_;
};

}  // namespace ragdoll_test
