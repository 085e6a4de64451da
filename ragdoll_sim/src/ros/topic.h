// A topic to publish on that knows whether anyone listens. ros::Publisher finds that out anew each
// time, by the topic's name among all of the node's: for all topics of a scene sixty times a second
// that costs as much as to compute what is sent.
#pragma once

#include <ros/master.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>

namespace ragdoll {

/// How many messages of so many bytes each may wait for a listener: `most`, halved until they take
/// no more than 10 MB. roscpp counts messages only, and keeps them for a listener that has stopped.
inline int queueLength(int most, std::size_t bytes) {
  constexpr std::size_t kQueueBytes = 10000000;
  while (most > 1 && static_cast<std::size_t>(most) * bytes > kQueueBytes) most /= 2;
  return most;
}

class Topic {
 public:
  Topic() = default;

  /// queue: messages that may wait for a listener; then the oldest are dropped. joined: called when
  /// someone begins to listen, by a thread for callbacks.
  template <class Message>
  static Topic advertise(
      ros::NodeHandle& nh, const std::string& name, int queue,
      std::function<void()> joined = [] {}) {
    Topic topic;
    const auto changed = [flag = topic.changed_](const ros::SingleSubscriberPublisher&) {
      *flag = true;
    };
    topic.advertise_ = [nh, name, changed, joined](int length) mutable {
      return nh.advertise<Message>(
          name, static_cast<std::uint32_t>(length),
          [changed, joined](const ros::SingleSubscriberPublisher& who) {
            changed(who);
            joined();
          },
          changed);
    };
    topic.most_ = topic.queue_ = queue;
    topic.publisher_ = topic.advertise_(queue);
    return topic;
  }

  /// Its queue as queueLength() says for messages of so many bytes. Where that is another, it is
  /// advertised anew, and who listens connects again: not while messages wait to be sent.
  void fit(std::size_t bytes) {
    const int queue = queueLength(most_, bytes);
    if (queue == queue_ || !ros::master::check()) return;  // to advertise would wait for it
    queue_ = queue;
    publisher_ = ros::Publisher();  // of two, roscpp would keep the first one's queue
    publisher_ = advertise_(queue);
    *changed_ = true;
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
  std::function<ros::Publisher(int)> advertise_;
  int most_ = 0, queue_ = 0;  ///< [messages]
  ros::Publisher publisher_;
};

}  // namespace ragdoll
