// Threads that call what ROS has for this node: as ros::AsyncSpinner, whose threads wake ten times
// a second even if there is nothing.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace ragdoll {

class CallbackThreads {
 public:
  explicit CallbackThreads(int count);
  /// Waits for what they call; at most kPatience more, but for nothing after ros::shutdown().
  ~CallbackThreads();

 private:
  static constexpr double kPatience = 10;  ///< [s] with nothing to call, until one looks around
  void run();

  std::atomic<bool> ends_{false};
  std::vector<std::thread> threads_;
};

}  // namespace ragdoll
