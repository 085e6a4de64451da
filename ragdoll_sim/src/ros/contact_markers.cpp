#include "contact_markers.h"

#include <algorithm>

#include "ragdoll_sim/ros/convert.h"

namespace ragdoll {
namespace {

using visualization_msgs::Marker;

constexpr double kPointSize = 0.03;  ///< [m] diameter
const Rgba kPointColor{0.98f, 0.75f, 0.18f, 1};
const Rgba kForceColor{0.13f, 0.55f, 0.28f, 0.95f};
const Vec3 kArrow{0.016, 0.04, 0.06};  ///< [m] shaft, head, head's length

}  // namespace

void ContactMarkers::hear(const ContactReport& report) {
  if (!(report.interval > 0)) return;
  if (drawn_) clear();
  for (const Touch& touch : report.touches) addTouch(touches_, touch);
  interval_ += report.interval;
}

void ContactMarkers::append(const Marker& empty, std::vector<Marker>& markers) {
  drawn_ = true;
  if (touches_.empty()) return;
  Marker points = empty;
  points.ns = "contacts";
  points.type = Marker::SPHERE_LIST;
  points.scale = toVector3(Vec3::Constant(kPointSize));
  points.color = toColor(kPointColor);
  std::vector<const ContactImpulse*> strongest;
  for (const Touch& touch : touches_) {
    points.points.push_back(toPoint(touch.contact.point));
    strongest.push_back(&touch.contact);
  }
  markers.push_back(std::move(points));

  const std::size_t count = std::min(strongest.size(), kMostArrows);
  std::partial_sort(strongest.begin(), strongest.begin() + static_cast<std::ptrdiff_t>(count),
                    strongest.end(), [](const ContactImpulse* a, const ContactImpulse* b) {
                      return a->impulse.squaredNorm() > b->impulse.squaredNorm();
                    });
  for (std::size_t i = 0; i < count; ++i) {
    const ContactImpulse& c = *strongest[i];
    const double length = std::min(kArrowScale * c.impulse.norm() / interval_, kLongestArrow);
    if (length < kShortestArrow) return;  // nor are those that follow longer
    Marker arrow = empty;
    arrow.ns = "forces";
    arrow.id = static_cast<int>(i);
    arrow.type = Marker::ARROW;
    arrow.points = {toPoint(c.point), toPoint(c.point + length * c.impulse.normalized())};
    arrow.scale = toVector3(kArrow);
    arrow.color = toColor(kForceColor);
    markers.push_back(std::move(arrow));
  }
}

}  // namespace ragdoll
