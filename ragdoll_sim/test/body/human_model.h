// The thesis's human as a Model made by hand, so that these tests need neither YAML nor the solver.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll::test {

inline Segment segment(const Skeleton& s, const std::string& name,
                       const std::vector<std::string>& particles) {
  Segment result;
  result.name = name;
  for (const std::string& p : particles) result.particles.push_back(s.particle(p));
  result.group = particles.size() > 2;
  return result;
}

inline Joint joint(const Skeleton& s, const std::string& name, JointSpec::Type type,
                   const std::string& parent, const std::string& child, const Vec3& axis) {
  Joint result;
  result.name = name;
  result.type = type;
  result.parent = s.segment(parent);
  result.child = s.segment(child);
  result.axis = axis;
  result.range = {0, 2.5};
  result.half_angle = 0.7;
  result.stiffness = result.damping = 0;
  return result;
}

/// Standing, facing +x, arms 15 degrees away, 1.75 m; the origin is the midpoint of the hips. The
/// measures of models/human.yaml.
inline Skeleton humanSkeleton() {
  Skeleton s;
  s.name = "human";
  std::vector<std::pair<std::string, Vec3>> rest = {{"head", {-0.01, 0, 0.6564}},
                                                    {"neck", {-0.045, 0, 0.5344}}};
  for (const auto& [side, y] : {std::pair<std::string, double>{"left_", 1}, {"right_", -1}}) {
    rest.push_back({side + "shoulder", {-0.01, 0.1850 * y, 0.4462}});
    rest.push_back({side + "elbow", {-0.01, 0.2583 * y, 0.1727}});
    rest.push_back({side + "hand", {-0.01, 0.3460 * y, -0.1545}});
    rest.push_back({side + "hip", {0, 0.11 * y, 0}});
    rest.push_back({side + "leg", {-0.01, 0.0864 * y, -0.0720}});
    rest.push_back({side + "knee", {-0.01, 0.0864 * y, -0.4964}});
    rest.push_back({side + "foot", {-0.01, 0.0864 * y, -0.9740}});
  }
  s.rest.resize(3, rest.size());
  const std::map<std::string, double> radius = {
      {"head", 0.105}, {"shoulder", 0.060}, {"elbow", 0.040}, {"hand", 0.040}, {"hip", 0.090},
      {"leg", 0.085},  {"knee", 0.055},     {"foot", 0.040},  {"neck", 0.060}};
  s.radius.resize(rest.size());
  for (std::size_t i = 0; i < rest.size(); ++i) {
    s.particles.push_back(rest[i].first);
    s.rest.col(i) = rest[i].second;
    const std::string& name = rest[i].first;
    s.radius[i] = radius.at(name.substr(name.find('_') + 1));
  }
  const auto group = [&](const std::vector<std::string>& names) {
    for (std::size_t i = 0; i < names.size(); ++i)
      for (std::size_t j = i + 1; j < names.size(); ++j)
        s.sticks.push_back({s.particle(names[i]), s.particle(names[j]), 0});
  };
  group({"neck", "left_shoulder", "right_shoulder", "left_hip", "right_hip"});
  group({"neck", "head"});
  for (const std::string side : {"left_", "right_"}) {
    group({side + "shoulder", side + "elbow"});
    group({side + "elbow", side + "hand"});
    group({side + "leg", side + "knee"});
    group({side + "knee", side + "foot"});
    group({side + "hip", side + "leg"});
  }
  group({"left_leg", "right_leg"});
  group({"left_leg", "right_hip"});
  group({"right_leg", "left_hip"});
  for (Stick& stick : s.sticks) stick.length = (s.rest.col(stick.a) - s.rest.col(stick.b)).norm();

  s.segments.push_back(
      segment(s, "torso", {"neck", "left_shoulder", "right_shoulder", "left_hip", "right_hip"}));
  s.segments.push_back(segment(s, "pelvis", {"left_hip", "right_hip", "left_leg", "right_leg"}));
  s.segments.push_back(segment(s, "head", {"neck", "head"}));
  using Type = JointSpec::Type;
  s.joints.push_back(joint(s, "neck", Type::kCone, "torso", "head", Vec3::UnitZ()));
  s.joints.push_back(joint(s, "hips", Type::kHinge, "torso", "pelvis", -Vec3::UnitY()));
  for (const std::string side : {"left_", "right_"}) {
    s.segments.push_back(segment(s, side + "upper_arm", {side + "shoulder", side + "elbow"}));
    s.segments.push_back(segment(s, side + "forearm", {side + "elbow", side + "hand"}));
    s.segments.push_back(segment(s, side + "thigh", {side + "leg", side + "knee"}));
    s.segments.push_back(segment(s, side + "shank", {side + "knee", side + "foot"}));
    s.joints.push_back(joint(s, side + "elbow", Type::kHinge, side + "upper_arm", side + "forearm",
                             -Vec3::UnitY()));
    s.joints.push_back(
        joint(s, side + "knee", Type::kHinge, side + "thigh", side + "shank", Vec3::UnitY()));
    s.joints.push_back(
        joint(s, side + "shoulder", Type::kPlanes, "torso", side + "upper_arm", Vec3::UnitZ()));
    s.joints.back().planes = {AngleRange{0, 2.1}, AngleRange{0.9, 3.9}, AngleRange{1.4, 3.9}};
  }
  s.named = static_cast<int>(s.particles.size());
  return s;
}

inline Model modelOf(const Skeleton& skeleton, int count = 1) {
  Model model;
  model.skeletons.push_back(skeleton);
  const int n = skeleton.size();
  model.start_position.resize(3, n * count);
  model.start_velocity.setZero(3, n * count);
  model.radius.resize(n * count);
  for (int i = 0; i < count; ++i) {
    model.ragdolls.push_back({"ragdoll" + (i ? std::to_string(i) : ""), 0, 0, i * n});
    model.start_position.middleCols(i * n, n) = skeleton.rest.colwise() + Vec3(0, 2.0 * i, 0);
    model.radius.segment(i * n, n) = skeleton.radius;
  }
  return model;
}

inline State stateOf(const Points& x, double time = 0) {
  State state;
  state.x = x;
  state.v.setZero(3, x.cols());
  state.time = time;
  return state;
}

/// Particles of the human posed by turns (world axes of the rest pose, each in its parent's frame)
/// about joints: pelvis (whole body), torso (about the hips), neck, left_/right_ shoulder, elbow,
/// leg, knee.
inline Points posed(const Skeleton& s, const std::map<std::string, Quat>& turns,
                    const Vec3& origin = Vec3::Zero()) {
  Points x(3, s.size());
  const auto rest = [&](const std::string& name) { return Vec3(s.rest.col(s.particle(name))); };
  const auto turn = [&](const std::string& name) {
    const auto it = turns.find(name);
    return it == turns.end() ? Quat::Identity() : it->second;
  };
  const auto put = [&](const std::string& name, const Vec3& p) { x.col(s.particle(name)) = p; };
  const auto at = [&](const std::string& name) { return Vec3(x.col(s.particle(name))); };
  const Quat pelvis = turn("pelvis"), torso = pelvis * turn("torso");
  const Vec3 hips = (rest("left_hip") + rest("right_hip")) / 2;
  for (const std::string name : {"neck", "left_shoulder", "right_shoulder"})
    put(name, origin + torso * (rest(name) - hips));
  put("head", at("neck") + torso * turn("neck") * (rest("head") - rest("neck")));
  for (const std::string side : {"left_", "right_"}) {
    for (const std::string name : {"hip", "leg"})
      put(side + name, origin + pelvis * (rest(side + name) - hips));
    const auto limb = [&](const Quat& parent, const std::string& a, const std::string& b,
                          const std::string& c) {
      const Quat upper = parent * turn(side + a), lower = upper * turn(side + b);
      put(side + b, at(side + a) + upper * (rest(side + b) - rest(side + a)));
      put(side + c, at(side + b) + lower * (rest(side + c) - rest(side + b)));
    };
    limb(torso, "shoulder", "elbow", "hand");
    limb(pelvis, "leg", "knee", "foot");
  }
  return x;
}

inline Quat turn(const Vec3& axis, double angle) {
  return Quat(Eigen::AngleAxisd(angle, axis.normalized()));
}

}  // namespace ragdoll::test
