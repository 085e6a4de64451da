// A topic to publish on that knows whether anyone listens. ros::Publisher finds that out anew each
// time, by the topic's name among all of the node's: for all topics of a scene sixty times a second
// that costs as much as to compute what is sent.
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>

namespace ragdoll {

class Topic {
 public:
  Topic() = default;

  /// joined: called when someone begins to listen, by a thread for callbacks.
  template <class Message>
  static Topic advertise(
      ros::NodeHandle& nh, const std::string& name, int queue,
      std::function<void()> joined = [] {}) {
    Topic topic;
    const auto changed = [flag = topic.changed_](const ros::SingleSubscriberPublisher&) {
      *flag = true;
    };
    topic.publisher_ = nh.advertise<Message>(
        name, static_cast<std::uint32_t>(queue),
        [changed, joined](const ros::SingleSubscriberPublisher& who) {
          changed(who);
          joined();
        },
        changed);
    return topic;
  }

  /// Whether anyone listens. Of one thread at a time.
  bool isHeard() const {
    if (changed_->exchange(false)) heard_ = publisher_.getNumSubscribers() > 0;
    return heard_;
  }

  const ros::Publisher& publisher() const { return publisher_; }

 private:
  std::shared_ptr<std::atomic<bool>> changed_ = std::make_shared<std::atomic<bool>>(true);
  mutable bool heard_ = false;
  ros::Publisher publisher_;
};

}  // namespace ragdoll
