// A trunk with a pelvis, an arm of three bones and a head: every kind of joint, few particles.
#pragma once

#include <cmath>
#include <string>

#include "support/worlds.h"

namespace ragdoll::test {

inline double rad(double deg) { return deg * M_PI / 180; }
inline double deg(double rad) { return rad * 180 / M_PI; }

inline SegmentSpec group(const std::string& name, const std::vector<std::string>& particles) {
  SegmentSpec s;
  s.name = name;
  s.particles = particles;
  s.group = true;
  s.where = "segments." + name;
  return s;
}

inline JointSpec joint(const std::string& name, const std::string& parent, const std::string& child,
                       const Vec3& axis) {
  JointSpec j;
  j.name = name;
  j.parent = parent;
  j.child = child;
  j.axis = axis;
  j.where = "joints." + name;
  return j;
}

inline JointSpec hinge(const std::string& name, const std::string& parent, const std::string& child,
                       const Vec3& axis, double begin_deg, double end_deg) {
  JointSpec j = joint(name, parent, child, axis);
  j.type = JointSpec::Type::kHinge;
  j.range = {rad(begin_deg), rad(end_deg)};
  return j;
}

inline JointSpec cone(const std::string& name, const std::string& parent, const std::string& child,
                      const Vec3& axis, double half_angle_deg) {
  JointSpec j = joint(name, parent, child, axis);
  j.type = JointSpec::Type::kCone;
  j.half_angle = rad(half_angle_deg);
  return j;
}

inline JointSpec planes(const std::string& name, const std::string& parent,
                        const std::string& child) {
  JointSpec j = joint(name, parent, child, Vec3::UnitZ());
  j.type = JointSpec::Type::kPlanes;
  return j;
}

inline void connect(SkeletonSpec& s, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = i + 1; j < names.size(); ++j)
      s.sticks.push_back(stick(names[i], names[j]));
}

/// Trunk {a, b, c, d}, pelvis {c, d, e, f} below it, head up, a right arm that hangs down. No
/// joints.
inline SkeletonSpec limbs() {
  SkeletonSpec s;
  s.name = "limbs";
  s.particles = {particle("a", {0.05, 0.2, 0.5}, 8),      particle("b", {0, -0.2, 0.5}, 7),
                 particle("c", {0, 0.1, 0}, 6),           particle("d", {0.02, -0.1, 0}, 9),
                 particle("e", {0.03, 0.1, -0.1}, 5),     particle("f", {0, -0.1, -0.12}, 4),
                 particle("head", {0.05, 0, 0.8}, 4),     particle("elbow", {0, -0.2, 0.2}, 2),
                 particle("hand", {0, -0.2, -0.05}, 1.5), particle("finger", {0, -0.2, -0.2}, 0.5)};
  connect(s, {"a", "b", "c", "d"});
  for (const auto& [p, q] :
       {std::pair("c", "e"), std::pair("c", "f"), std::pair("d", "e"), std::pair("d", "f"),
        std::pair("e", "f"), std::pair("a", "head"), std::pair("b", "elbow"),
        std::pair("elbow", "hand"), std::pair("hand", "finger")})
    s.sticks.push_back(stick(p, q));
  s.segments = {group("trunk", {"a", "b", "c", "d"}),
                group("pelvis", {"c", "d", "e", "f"}),
                bone("head", "a", "head"),
                bone("upper_arm", "b", "elbow"),
                bone("forearm", "elbow", "hand"),
                bone("palm", "hand", "finger")};
  return s;
}

/// The same with a joint of every kind.
inline SkeletonSpec jointedLimbs() {
  SkeletonSpec s = limbs();
  JointSpec elbow = hinge("elbow", "upper_arm", "forearm", -Vec3::UnitY(), 0, 145);
  elbow.twist = rad(50);
  s.joints = {cone("neck", "trunk", "head", Vec3(0, -0.5, 0.8), 60),
              cone("shoulder", "trunk", "upper_arm", Vec3(0.6, -0.6, -0.5), 100), elbow,
              hinge("wrist", "forearm", "palm", -Vec3::UnitY(), -60, 70),
              hinge("waist", "trunk", "pelvis", -Vec3::UnitY(), -20, 60)};
  return s;
}

}  // namespace ragdoll::test
