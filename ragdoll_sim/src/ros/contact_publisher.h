// ~contacts, ~largest_contact, ~impacts and ~wrenches/<name>, from the contacts of a snapshot.
#pragma once

#include <ros/node_handle.h>

#include <memory>
#include <string>
#include <vector>

#include "largest_contact.h"
#include "outbox.h"
#include "ragdoll_sim/world/snapshot.h"
#include "topic.h"

namespace ragdoll {

class ContactPublisher {
 public:
  ContactPublisher(ros::NodeHandle& nh, std::string world_frame);

  /// Topics for the obstacles and pins that are there.
  void follow(const Snapshot& world, const std::vector<std::string>& pin_names);
  /// Whether anyone listens to one of the topics.
  bool wanted() const;
  void publish(const Snapshot& world, const ros::Time& now, Outbox& out);

 private:
  void publishWrenches(const Snapshot& world, const ros::Time& now, Outbox& out);
  void publishWrench(std::size_t topic, const ContactReport& report, const Vec3& impulse,
                     const Vec3& moment, const std::string& frame, const Pose& pose,
                     const ros::Time& now, Outbox& out);

  ros::NodeHandle nh_;
  std::string world_frame_;
  Topic contacts_, impacts_;
  LargestContact largest_;
  std::shared_ptr<const Model> model_;  ///< that names_ are of, with pin_names_
  std::vector<std::string> pin_names_, names_;
  std::vector<Topic> wrenches_;  ///< of obstacles, then of pins
};

}  // namespace ragdoll
