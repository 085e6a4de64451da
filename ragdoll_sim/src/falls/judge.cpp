#include "ragdoll_sim/falls/judge.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ragdoll_sim/core/error.h"

namespace ragdoll::falls {
namespace {

constexpr double kTouch = 0.002;   ///< [m] a particle that is so near touches
constexpr double kUpright = 0.7;   ///< cosine of the trunk's lean up to which the body sits or kneels
constexpr double kFacing = 0.6;    ///< cosine between chest and vertical up to which it lies on its back or front

/// [m] of a point from the surface of a plane or box, < 0 inside.
double distance(const Obstacle& o, const Vec3& x) {
  const Vec3 p = o.pose.orientation.conjugate() * (x - o.pose.position);
  if (o.type == ObstacleSpec::Type::kPlane) return p.z();
  const Vec3 out = p.cwiseAbs() - o.half;
  return out.cwiseMax(0).norm() + std::min(0.0, out.maxCoeff());
}

bool isFoot(const std::string& name) {
  return name.size() >= 4 && name.compare(name.size() - 4, 4, "foot") == 0;
}

}  // namespace

Judge::Judge(std::vector<std::string> names, std::vector<double> radii, std::vector<Obstacle> floors)
    : names_(std::move(names)), radii_(std::move(radii)), floors_(std::move(floors)) {}

void Judge::look(double time, const Eigen::Ref<const Points>& x, const Eigen::Ref<const Points>& v) {
  const int n = static_cast<int>(names_.size());
  if (!outcome_.impact_time && last_x_.cols() > 0) {
    double least = kTouch;
    int hit = -1;
    for (int i = 0; i < n; ++i) {
      if (isFoot(names_[i])) continue;
      for (const Obstacle& floor : floors_) {
        const double gap = distance(floor, x.col(i)) - radii_[i];
        if (gap >= least) continue;
        least = gap;
        hit = i;
      }
    }
    if (hit >= 0) {
      outcome_.impact_time = time;
      outcome_.impact_body = names_[hit];
      outcome_.impact_region = regionOf(names_[hit]);
      outcome_.impact_speed = last_v_.col(hit).norm();
    }
  }
  last_x_ = x.leftCols(n);
  last_v_ = v.leftCols(n);
}

int Judge::index(const char* name) const {
  const auto it = std::find(names_.begin(), names_.end(), name);
  if (it == names_.end()) throw Error("fall", std::string("has no particle '") + name + "'");
  return static_cast<int>(it - names_.begin());
}

Outcome Judge::outcome() const {
  Outcome all = outcome_;
  const auto at = [this](const char* name) -> Vec3 { return last_x_.col(index(name)); };
  all.end_pose = poseClass(at("neck"), at("left_shoulder"), at("right_shoulder"), at("left_hip"),
                           at("right_hip"));
  all.end_head_height = at("head").z();
  return all;
}

std::string poseClass(const Vec3& neck, const Vec3& left_shoulder, const Vec3& right_shoulder,
                      const Vec3& left_hip, const Vec3& right_hip) {
  const Vec3 up = (neck - 0.5 * (left_hip + right_hip)).normalized();
  const Vec3 left = (left_shoulder - right_shoulder).normalized();
  const Vec3 front = left.cross(up).normalized();
  if (up.z() > kUpright) return "upright";
  if (std::abs(front.z()) > kFacing) return front.z() > 0 ? "supine" : "prone";
  return left.z() > 0 ? "on_right_side" : "on_left_side";
}

std::string regionOf(const std::string& particle) {
  const std::size_t side = particle.compare(0, 5, "left_") == 0    ? 5
                           : particle.compare(0, 6, "right_") == 0 ? 6
                                                                   : 0;
  const std::string name = particle.substr(side);
  return name == "leg" ? "hip" : name == "neck" ? "head" : name;
}

}  // namespace ragdoll::falls
