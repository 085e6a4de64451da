#include "callback_threads.h"

#include <ros/callback_queue.h>
#include <ros/init.h>

namespace ragdoll {

CallbackThreads::CallbackThreads(int count) {
  for (int i = 0; i < count; ++i) threads_.emplace_back([this] { run(); });
}

CallbackThreads::~CallbackThreads() {
  ends_ = true;
  for (std::thread& thread : threads_) thread.join();
}

/// ros::shutdown() disables the queue, which wakes all.
void CallbackThreads::run() {
  while (ros::ok() && !ends_ &&
         ros::getGlobalCallbackQueue()->callOne(ros::WallDuration(kPatience)) !=
             ros::CallbackQueue::Disabled)
    continue;
}

}  // namespace ragdoll
