// What a fall came to, from its states: the labels that are known after it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/falls/fall.h"

namespace ragdoll::falls {

struct Outcome {
  std::optional<double> impact_time;  ///< [s]; nothing: it hit nothing
  std::string impact_body, impact_region;
  double impact_speed = 0;    ///< [m/s] of that particle, one state before
  std::string end_pose;       ///< upright | supine | prone | on_left_side | on_right_side
  double end_head_height = 0; ///< [m]
};

/// Looks at states one after the other. The impact: the first state in which another particle than
/// a foot touches what it falls on (furniture does not count).
class Judge {
 public:
  /// Names and radii of the particles that will be looked at; floors: of FallScene. They stand still.
  Judge(std::vector<std::string> names, std::vector<double> radii, std::vector<Obstacle> floors);

  /// 3 x n [m], [m/s]; further columns do not count.
  void look(double time, const Eigen::Ref<const Points>& x, const Eigen::Ref<const Points>& v);
  /// After the last state.
  Outcome outcome() const;

 private:
  int index(const char* name) const;

  std::vector<std::string> names_;
  std::vector<double> radii_;
  std::vector<Obstacle> floors_;
  Outcome outcome_;
  Points last_x_, last_v_;
};

/// How a body lies, from where these particles are [m].
std::string poseClass(const Vec3& neck, const Vec3& left_shoulder, const Vec3& right_shoulder,
                      const Vec3& left_hip, const Vec3& right_hip);

/// "left_knee" -> "knee"; a leg is the hip, a neck the head.
std::string regionOf(const std::string& particle);

}  // namespace ragdoll::falls
