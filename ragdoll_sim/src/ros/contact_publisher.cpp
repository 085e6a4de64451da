#include "contact_publisher.h"

#include <geometry_msgs/WrenchStamped.h>
#include <ragdoll_msgs/ContactStates.h>
#include <ros/console.h>
#include <ros/master.h>

#include <algorithm>
#include <utility>

#include "contact_messages.h"
#include "ragdoll_sim/ros/convert.h"
#include "topic_names.h"

namespace ragdoll {
namespace {

constexpr int kReportQueue = 100;
constexpr int kImpactQueue = 10000;           ///< one step may have many
constexpr std::size_t kMostWrenches = 200;    ///< topics
constexpr std::size_t kContactsBytes = 4000;  ///< of a body that lies, in ~contacts

Pose inverse(const Pose& pose) {
  const Quat back = pose.orientation.conjugate();
  return {-(back * pose.position), back};
}

}  // namespace

ContactPublisher::ContactPublisher(ros::NodeHandle& nh, std::string world_frame)
    : nh_(nh), world_frame_(std::move(world_frame)), largest_(nh) {
  contacts_ = Topic::advertise<ragdoll_msgs::ContactStates>(nh, "contacts", kReportQueue);
  impacts_ = Topic::advertise<ragdoll_msgs::Impact>(nh, "impacts", kImpactQueue);
}

void ContactPublisher::follow(const Snapshot& world, const std::vector<std::string>& pin_names) {
  if (world.model == model_ && pin_names == pin_names_) return;
  contacts_.fit(world.model->ragdolls.size() * kContactsBytes);
  model_ = world.model;
  pin_names_ = pin_names;
  std::vector<std::string> names;
  for (const Obstacle& o : world.model->obstacles) names.push_back(o.name);
  names.insert(names.end(), pin_names.begin(), pin_names.end());
  if (names.size() > kMostWrenches) {
    if (names.size() != names_.size())
      ROS_INFO("%zu obstacles and pins are too many for ~wrenches; ~contacts tells of all",
               names.size());
    wrenches_.clear();
    names_ = std::move(names);
    return;
  }
  if (names == names_) return;
  if (!ros::master::check()) {  // to advertise would wait for it; nobody new finds the node anyway
    wrenches_.clear();
    names_ = std::move(names);
    return;
  }
  std::vector<Topic> topics;
  for (const std::string& name : topicNames(names))
    topics.push_back(
        Topic::advertise<geometry_msgs::WrenchStamped>(nh_, "wrenches/" + name, kReportQueue));
  wrenches_ = std::move(topics);
  names_ = std::move(names);
}

bool ContactPublisher::wanted() const {
  return largest_.wanted() || contacts_.isHeard() || impacts_.isHeard() ||
         std::any_of(wrenches_.begin(), wrenches_.end(),
                     [](const Topic& topic) { return topic.isHeard(); });
}

void ContactPublisher::publish(const Snapshot& world, const ros::Time& now, Outbox& out) {
  if (!world.contacts) return;
  const ContactReport& report = *world.contacts;
  const std_msgs::Header header = toHeader(world_frame_, now);
  if (impacts_.isHeard())
    for (const ImpactReport& impact : report.impacts) {
      ragdoll_msgs::Impact m = toImpact(*world.model, impact);
      m.header = header;
      out.add(impacts_, std::move(m));
    }
  largest_.publish(world, header, out);
  if (!(report.interval > 0)) return;  // no step since the last one
  if (contacts_.isHeard()) {
    ragdoll_msgs::ContactStates m;
    m.header = header;
    m.step = report.step;
    m.interval = report.interval;
    for (const Touch& touch : report.touches)
      m.contacts.push_back(toContactState(*world.model, touch, report.interval));
    out.add(contacts_, std::move(m));
  }
  publishWrenches(world, now, out);
}

void ContactPublisher::publishWrenches(const Snapshot& world, const ros::Time& now, Outbox& out) {
  const ContactReport& report = *world.contacts;
  const Model& model = *world.model;
  const std::size_t obstacles = model.obstacles.size();
  if (wrenches_.size() != obstacles + model.pins.size()) return;
  for (std::size_t k = 0; k < obstacles && k < report.on_obstacles.size(); ++k) {
    const Obstacle& o = model.obstacles[k];
    Pose frame;  // of the followed frame, as the obstacle is fixed in it
    if (!o.frame.empty()) {
      const Pose back = inverse(o.pose), &now_at = world.state.obstacles[k];
      frame = {now_at.position + now_at.orientation * back.position,
               now_at.orientation * back.orientation};
    }
    publishWrench(k, report, report.on_obstacles[k], report.moments[k],
                  o.frame.empty() ? world_frame_ : o.frame, frame, now, out);
  }
  for (std::size_t p = 0; p < model.pins.size() && p < report.on_pins.size(); ++p) {
    const Pin& pin = model.pins[p];
    const Vec3 place = world.state.x.col(pin.particle);
    const bool follows = p < world.pin_frames.size() && world.pin_frames[p].has_value();
    publishWrench(obstacles + p, report, report.on_pins[p], place.cross(report.on_pins[p]),
                  follows ? pin.frame : world_frame_, follows ? *world.pin_frames[p] : Pose(), now,
                  out);
  }
}

/// impulse, moment: about the world's origin, over the interval.
void ContactPublisher::publishWrench(std::size_t topic, const ContactReport& report,
                                     const Vec3& impulse, const Vec3& moment,
                                     const std::string& frame, const Pose& pose,
                                     const ros::Time& now, Outbox& out) {
  if (!wrenches_[topic].isHeard()) return;
  const Quat back = pose.orientation.conjugate();
  geometry_msgs::WrenchStamped m;
  m.header = toHeader(frame, now);
  m.wrench.force = toVector3(back * impulse / report.interval);
  m.wrench.torque = toVector3(back * (moment - pose.position.cross(impulse)) / report.interval);
  out.add(wrenches_[topic], std::move(m));
}

}  // namespace ragdoll
