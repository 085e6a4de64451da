#include "touch_figures.h"

#include <QLabel>
#include <QString>
#include <cmath>

namespace ragdoll_rviz {
namespace {

constexpr int kQueue = 100;

double sizeOf(const geometry_msgs::Vector3& v) { return std::hypot(v.x, v.y, v.z); }

QString newtons(double force) { return QString("%1 N").arg(force, 0, 'f', 0); }

/// "ragdoll/head on floor"
QString pairOf(const std::string& ragdoll, const std::string& body, const std::string& other) {
  return QString::fromStdString(ragdoll + "/" + body + " on " + other);
}

}  // namespace

void TouchFigures::setLabels(QLabel* force, QLabel* impact) {
  force_ = force;
  impact_ = impact;
  for (QLabel* label : {force_, impact_}) label->setWordWrap(true);
  clear();
}

void TouchFigures::listen(ros::NodeHandle& nh, const std::string& node) {
  using ragdoll_msgs::ContactStates;
  using ragdoll_msgs::Impact;
  clear();
  contact_ = nh.subscribe<ContactStates>(
      node + "/largest_contact", 1, [this](const ContactStates::ConstPtr& m) { hearContact(*m); });
  impacts_ = nh.subscribe<Impact>(node + "/impacts", kQueue,
                                  [this](const Impact::ConstPtr& m) { hearImpact(*m); });
}

void TouchFigures::stop() {
  contact_.shutdown();
  impacts_.shutdown();
}

void TouchFigures::clear() {
  force_->setText("-");
  impact_->setText("-");
  last_ = 0;
}

void TouchFigures::hearContact(const ragdoll_msgs::ContactStates& m) {
  if (m.contacts.empty()) return force_->setText("none");
  const ragdoll_msgs::ContactState& largest = m.contacts.front();
  force_->setText(newtons(sizeOf(largest.force)) + ", " +
                  pairOf(largest.ragdoll, largest.body, largest.other));
}

void TouchFigures::hearImpact(const ragdoll_msgs::Impact& m) {
  if (m.over && m.id != last_) return;  // another has begun since
  last_ = m.id;
  const QString text = QString("%1 m/s, %2")
                           .arg(m.approach_speed, 0, 'f', 2)
                           .arg(pairOf(m.ragdoll, m.region, m.other));
  impact_->setText(m.over ? newtons(m.peak_force) + ", " + text : text);
}

}  // namespace ragdoll_rviz
