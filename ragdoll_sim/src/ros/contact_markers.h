// Contacts to look at (~show_contacts): a ball at each point that touches, and an arrow along the
// force on the body there, of the mean since the last picture.
#pragma once

#include <visualization_msgs/Marker.h>

#include <vector>

#include "ragdoll_sim/world/contacts.h"

namespace ragdoll {

class ContactMarkers {
 public:
  static constexpr double kArrowScale = 0.002;     ///< [m/N]
  static constexpr double kLongestArrow = 1.2;     ///< [m]
  static constexpr double kShortestArrow = 0.01;   ///< [m] a shorter one is not drawn
  static constexpr std::size_t kMostArrows = 200;  ///< those of the largest forces

  /// What touched since the last one; without a step in between what was stays.
  void hear(const ContactReport& report);

  /// Appends the picture. `empty` has header and lifetime; the namespaces are `contacts`, one
  /// marker with all points, and `forces`, an arrow each.
  void append(const visualization_msgs::Marker& empty,
              std::vector<visualization_msgs::Marker>& markers);

  void clear() { *this = {}; }

 private:
  std::vector<Touch> touches_;
  double interval_ = 0;  ///< [s] that they are of
  bool drawn_ = false;   ///< what comes next begins another picture
};

}  // namespace ragdoll
