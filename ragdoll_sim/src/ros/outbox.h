// Messages that are sent together: roscpp's thread of sockets is then woken for all of them once.
#pragma once

#include <boost/make_shared.hpp>
#include <functional>
#include <utility>
#include <vector>

#include "topic.h"

namespace ragdoll {

class Outbox {
 public:
  /// topic: of messages of that kind.
  template <class Message>
  void add(const Topic& topic, Message message) {
    add(topic, boost::make_shared<Message>(std::move(message)));
  }
  /// Shared with listeners in this process, which else would get copies of their own.
  template <class Message>
  void add(const Topic& topic, boost::shared_ptr<Message> message) {
    sends_.push_back([publisher = topic.publisher(), message = std::move(message)] {
      publisher.publish(message);
    });
  }

  /// In the order of add().
  void send() {
    for (const auto& send : sends_) send();
    sends_.clear();
  }

 private:
  std::vector<std::function<void()>> sends_;
};

}  // namespace ragdoll
