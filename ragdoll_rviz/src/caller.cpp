#include "caller.h"

namespace ragdoll_rviz {

Caller::Caller() {
  thread_ = std::thread([this] { run(); });
}

Caller::~Caller() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
    active_.shutdown();
  }
  wake_.notify_all();
  thread_.join();
}

bool Caller::post(std::function<void()> job) {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (jobs_.size() >= kMaxWaiting) return false;
    jobs_.push_back(std::move(job));
  }
  wake_.notify_all();
  return true;
}

bool Caller::begin(const ros::ServiceClient& client) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (stopping_) return false;
  active_ = client;
  return true;
}

void Caller::end() {
  std::lock_guard<std::mutex> lock(mutex_);
  active_ = ros::ServiceClient();
}

void Caller::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
    if (stopping_) return;
    const std::function<void()> job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    job();
    lock.lock();
  }
}

}  // namespace ragdoll_rviz
