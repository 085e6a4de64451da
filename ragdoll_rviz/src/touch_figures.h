// The panel's two lines of what touches: the largest contact force now and the last impact, from
// ~largest_contact and ~impacts. A node keeps contacts only while someone listens, so listen only
// while the lines are seen.
#pragma once

#ifndef Q_MOC_RUN
#include <ragdoll_msgs/ContactStates.h>
#include <ragdoll_msgs/Impact.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#endif

#include <cstdint>
#include <string>

class QLabel;

namespace ragdoll_rviz {

class TouchFigures {
 public:
  /// The labels outlive it.
  void setLabels(QLabel* force, QLabel* impact);

  /// To the node of this name, and to no other.
  void listen(ros::NodeHandle& nh, const std::string& node);
  void stop();
  /// Forgets what was.
  void clear();

 private:
  void hearContact(const ragdoll_msgs::ContactStates& message);
  void hearImpact(const ragdoll_msgs::Impact& message);

  QLabel *force_ = nullptr, *impact_ = nullptr;
  ros::Subscriber contact_, impacts_;
  std::uint32_t last_ = 0;  ///< the shown impact's id
};

}  // namespace ragdoll_rviz
