#include "largest_contact.h"

#include <ragdoll_msgs/ContactStates.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "contact_messages.h"

namespace ragdoll {
namespace {

constexpr int kContactQueue = 10;
constexpr std::chrono::milliseconds kContactPeriod{250};

}  // namespace

LargestContact::LargestContact(ros::NodeHandle& nh) {
  topic_ = Topic::advertise<ragdoll_msgs::ContactStates>(nh, "largest_contact", kContactQueue);
}

void LargestContact::publish(const Snapshot& world, const std_msgs::Header& header, Outbox& out) {
  if (!wanted()) return clear();
  hear(world);
  const Clock::time_point now = Clock::now();
  if (now < due_ || !(interval_ > 0)) return;
  due_ = now + kContactPeriod;
  ragdoll_msgs::ContactStates m;
  m.header = header;
  m.step = world.contacts->step;
  m.interval = interval_;
  const auto largest =
      std::max_element(touches_.begin(), touches_.end(), [](const Touch& a, const Touch& b) {
        return a.contact.impulse.squaredNorm() < b.contact.impulse.squaredNorm();
      });
  if (largest != touches_.end())
    m.contacts.push_back(toContactState(*world.model, *largest, interval_));
  out.add(topic_, std::move(m));
  clear();
}

void LargestContact::hear(const Snapshot& world) {
  if (world.mark.run != run_) clear();
  run_ = world.mark.run;
  for (const Touch& touch : world.contacts->touches) addTouch(touches_, touch);
  interval_ += world.contacts->interval;
}

void LargestContact::clear() {
  touches_.clear();
  interval_ = 0;
}

}  // namespace ragdoll
