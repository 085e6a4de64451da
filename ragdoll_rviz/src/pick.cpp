#include "pick.h"

#include <algorithm>
#include <vector>

namespace ragdoll_rviz {
namespace {

using Eigen::Vector3d;

struct Approach {
  double depth = 0;     ///< [m] along the ray, >= 0
  double share = 0;     ///< along the segment, in [0, 1]
  double distance = 0;  ///< [m]
};

/// Closest approach of the ray and the segment a-b [Ericson2005, sec. 5.1.9].
Approach closest(const Ray& ray, const Vector3d& a, const Vector3d& b) {
  constexpr double kParallel = 1e-12;
  const Vector3d e = b - a, r = ray.origin - a;
  const double ee = e.squaredNorm(), de = ray.direction.dot(e), dr = ray.direction.dot(r);
  const double det = ee - de * de;  // of unit direction
  Approach out;
  if (det > kParallel * ee) out.share = std::clamp((e.dot(r) - de * dr) / det, 0.0, 1.0);
  out.depth = std::max(0.0, ray.direction.dot(a + out.share * e - ray.origin));
  if (ee > 0)
    out.share = std::clamp((ray.origin + out.depth * ray.direction - a).dot(e) / ee, 0.0, 1.0);
  out.distance = (ray.origin + out.depth * ray.direction - a - out.share * e).norm();
  return out;
}

Vector3d at(const ragdoll_msgs::RagdollState& state, std::size_t particle) {
  const geometry_msgs::Point& p = state.positions[particle];
  return {p.x, p.y, p.z};
}

/// Sticks that are no bone are called after their ends.
bool isBone(const ragdoll_msgs::RagdollModel& model, const ragdoll_msgs::Stick& stick) {
  return stick.name != model.particles[stick.a] + "-" + model.particles[stick.b];
}

}  // namespace

std::optional<Hit> pick(const Ray& ray, const ragdoll_msgs::Model& model,
                        const ragdoll_msgs::State& state) {
  std::optional<Hit> hit;
  for (const double radius : {kLimbRadius, kTrunkRadius}) {
    const auto consider = [&](const Approach& a, const std::string& body, const Vector3d& offset) {
      if (a.distance <= radius && a.depth > 0 && (!hit || a.depth < hit->depth))
        hit = Hit{body, offset, a.depth};
    };
    for (std::size_t i = 0; i < std::min(model.ragdolls.size(), state.ragdolls.size()); ++i) {
      const ragdoll_msgs::RagdollModel& m = model.ragdolls[i];
      const ragdoll_msgs::RagdollState& s = state.ragdolls[i];
      if (m.name != s.name || m.particles.size() != s.positions.size()) continue;
      std::vector<bool> alone(m.particles.size(), true);
      for (const ragdoll_msgs::Stick& stick : m.sticks) {
        if (stick.a >= alone.size() || stick.b >= alone.size()) continue;
        alone[stick.a] = alone[stick.b] = false;
        const Vector3d a = at(s, stick.a), b = at(s, stick.b);
        const Approach approach = closest(ray, a, b);
        if (isBone(m, stick))  // whose own point is its middle
          consider(approach, m.name + "/" + stick.name, (approach.share - 0.5) * (b - a));
        else
          consider(approach, m.name + "/" + m.particles[approach.share < 0.5 ? stick.a : stick.b],
                   Vector3d::Zero());
      }
      for (std::size_t p = 0; p < alone.size(); ++p)
        if (alone[p])
          consider(closest(ray, at(s, p), at(s, p)), m.name + "/" + m.particles[p],
                   Vector3d::Zero());
    }
    if (hit) break;
  }
  return hit;
}

}  // namespace ragdoll_rviz
