#include "ragdoll_sim/ros/convert.h"

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/number_text.h"
#include "ragdoll_sim/core/findings.h"
#include "ragdoll_sim/world/text.h"

namespace ragdoll {

std_msgs::Header toHeader(const std::string& frame, const ros::Time& stamp) {
  std_msgs::Header header;
  header.frame_id = frame;
  header.stamp = stamp;
  return header;
}

geometry_msgs::Point toPoint(const Vec3& v) {
  geometry_msgs::Point p;
  p.x = v.x(), p.y = v.y(), p.z = v.z();
  return p;
}

geometry_msgs::Vector3 toVector3(const Vec3& v) {
  geometry_msgs::Vector3 m;
  m.x = v.x(), m.y = v.y(), m.z = v.z();
  return m;
}

geometry_msgs::Quaternion toQuaternion(const Quat& q) {
  geometry_msgs::Quaternion m;
  m.x = q.x(), m.y = q.y(), m.z = q.z(), m.w = q.w();
  return m;
}

geometry_msgs::Pose toPose(const Pose& pose) {
  geometry_msgs::Pose m;
  m.position = toPoint(pose.position);
  m.orientation = toQuaternion(pose.orientation);
  return m;
}

geometry_msgs::Transform toTransform(const Pose& pose) {
  geometry_msgs::Transform m;
  m.translation = toVector3(pose.position);
  m.rotation = toQuaternion(pose.orientation);
  return m;
}

std_msgs::ColorRGBA toColor(const Rgba& color) {
  std_msgs::ColorRGBA m;
  m.r = color.r, m.g = color.g, m.b = color.b, m.a = color.a;
  return m;
}

Vec3 fromPoint(const geometry_msgs::Point& p) { return {p.x, p.y, p.z}; }

Vec3 fromVector3(const geometry_msgs::Vector3& v) { return {v.x, v.y, v.z}; }

Pose fromTransform(const geometry_msgs::Transform& t) {
  const auto& q = t.rotation;
  return {fromVector3(t.translation), Quat(q.w, q.x, q.y, q.z).normalized()};
}

namespace {

/// The segment that the stick is, if it has a name, else "a-b".
std::string stickName(const Skeleton& skeleton, const Stick& stick) {
  for (const Segment& s : skeleton.segments) {
    if (s.group || s.particles.size() != 2) continue;
    const auto has = [&](int p) { return s.particles[0] == p || s.particles[1] == p; };
    if (has(stick.a) && has(stick.b)) return s.name;
  }
  return skeleton.particles[stick.a] + "-" + skeleton.particles[stick.b];
}

ragdoll_msgs::RagdollModel toRagdollModel(const Ragdoll& ragdoll, const Skeleton& skeleton) {
  ragdoll_msgs::RagdollModel m;
  m.name = ragdoll.name;
  const auto names = skeleton.particles.begin();
  m.particles.assign(names, names + skeleton.named);
  const Eigen::VectorXd masses = pointMasses(skeleton);
  m.masses.assign(masses.data(), masses.data() + masses.size());
  m.mass = masses.sum();
  m.sticks.resize(skeleton.sticks.size());
  for (std::size_t k = 0; k < skeleton.sticks.size(); ++k) {
    const Stick& stick = skeleton.sticks[k];
    ragdoll_msgs::Stick& out = m.sticks[skeleton.stick_order[k]];
    out.name = stickName(skeleton, stick);
    out.a = static_cast<std::uint16_t>(stick.a);
    out.b = static_cast<std::uint16_t>(stick.b);
    out.length = stick.length;
  }
  for (const Joint& joint : skeleton.joints) m.joints.push_back(joint.name);
  return m;
}

}  // namespace

ragdoll_msgs::Model toModelMsg(const Scene& scene, const Model& model,
                               const std_msgs::Header& header) {
  ragdoll_msgs::Model m;
  m.header = header;
  m.scene_yaml = scene.text;
  for (const Ragdoll& r : model.ragdolls)
    m.ragdolls.push_back(toRagdollModel(r, model.skeletonOf(r)));
  return m;
}

ragdoll_msgs::State toStateMsg(const Model& model, const State& state, const RunMark& mark,
                               const std_msgs::Header& header) {
  ragdoll_msgs::State m;
  m.header = header;
  m.run = mark.run;
  m.told = mark.told;
  m.followed = mark.followed;
  m.step = state.step;
  m.time = state.time;
  m.ragdolls.resize(model.ragdolls.size());
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i) {
    const Ragdoll& r = model.ragdolls[i];
    const int n = model.skeletonOf(r).named;
    ragdoll_msgs::RagdollState& out = m.ragdolls[i];
    out.name = r.name;
    out.asleep = state.asleep[i] != 0;
    out.positions.reserve(n);
    out.velocities.reserve(n);
    for (int p = r.first; p < r.first + n; ++p) {
      out.positions.push_back(toPoint(state.x.col(p)));
      out.velocities.push_back(toVector3(state.v.col(p)));
    }
  }
  return m;
}

bool fits(const Model& model, const ragdoll_msgs::State& message) {
  if (message.ragdolls.size() != model.ragdolls.size()) return false;
  for (std::size_t i = 0; i < message.ragdolls.size(); ++i) {
    const Ragdoll& ragdoll = model.ragdolls[i];
    const ragdoll_msgs::RagdollState& state = message.ragdolls[i];
    const auto n = static_cast<std::size_t>(model.skeletonOf(ragdoll).named);
    if (state.name != ragdoll.name || state.positions.size() != n) return false;
    for (const geometry_msgs::Point& p : state.positions)
      if (!fromPoint(p).allFinite()) return false;
  }
  return true;
}

void putState(const Model& model, const ragdoll_msgs::State& message, State& state) {
  state.step = message.step;
  state.time = message.time;
  for (std::size_t i = 0; i < message.ragdolls.size(); ++i) {
    const auto& positions = message.ragdolls[i].positions;
    for (std::size_t p = 0; p < positions.size(); ++p)
      state.x.col(model.ragdolls[i].first + static_cast<Eigen::Index>(p)) = fromPoint(positions[p]);
  }
}

namespace {

/// The nearest that a message can hold.
ros::Duration toDuration(double seconds) {
  constexpr double kLongest = 2147483647;  // [s]
  return ros::Duration(std::clamp(seconds, -kLongest, kLongest));
}

}  // namespace

ragdoll_msgs::PokeEvent toPokeEvent(const Event& event, const std_msgs::Header& header) {
  const Poke& poke = event.poke;
  ragdoll_msgs::PokeEvent m;
  m.header = header;
  m.step = event.step;
  m.body_name = poke.body_name;
  m.point = toPoint(poke.point);
  m.force = toVector3(poke.force);
  m.duration = toDuration(poke.duration);
  m.run = event.run;
  return m;
}

namespace {

/// The numbers as they are: another rounding would make another motion.
Pose fromPose(const geometry_msgs::Pose& m, const char* name) {
  const auto& q = m.orientation;
  const Pose pose{fromPoint(m.position), Quat(q.w, q.x, q.y, q.z)};
  checkPosition(name, pose.position);
  if (!(std::abs(pose.orientation.norm() - 1) < 1e-6))
    throw Error(name, "has an orientation of length " + numberText(pose.orientation.norm()) +
                          "; it must be 1");
  return pose;
}

void checkSeconds(double seconds, const char* name, bool positive) {
  if (std::isfinite(seconds) && (positive ? seconds > 0 : seconds >= 0)) return;
  throw Error(name,
              "is " + numberText(seconds) + "; it must be " + (positive ? ">" : ">=") + " 0 [s]");
}

}  // namespace

Event fromPokeEvent(const Model& model, const ragdoll_msgs::PokeEvent& m) {
  Event event{m.step, {}, m.run};
  event.poke.body_name = m.body_name;
  event.poke.force = fromVector3(m.force);
  event.poke.point = fromPoint(m.point);
  event.poke.duration = m.duration.toSec();
  checkFinite(event.poke.force, "force", "[N]");
  checkFinite(event.poke.point, "point", "[m]");
  if (!m.body_name.empty()) event.poke.body = findBody(model, m.body_name);
  return event;
}

ragdoll_msgs::FollowedFrame toFollowedMsg(const FollowedFrame& followed,
                                          const std_msgs::Header& header) {
  const Glide& glide = followed.glide;
  ragdoll_msgs::FollowedFrame m;
  m.header = header;
  m.step = followed.step;
  m.run = followed.run;
  m.number = followed.number;
  m.frame = glide.frame;
  m.start = toPose(glide.from);
  m.goal = toPose(glide.to);
  m.age = glide.age;
  m.duration = glide.duration;
  m.jump = glide.jump;
  for (const Glide::Particle& p : glide.held) {
    m.held.emplace_back();
    m.held.back().name = p.name;
    m.held.back().offset = toVector3(p.offset);
    m.held.back().age = p.age;
  }
  return m;
}

FollowedFrame fromFollowedMsg(const Model& model, const ragdoll_msgs::FollowedFrame& m) {
  FollowedFrame followed{m.step, m.run, m.number, {}};
  Glide& glide = followed.glide;
  glide.frame = m.frame;
  glide.from = fromPose(m.start, "start");
  glide.to = fromPose(m.goal, "goal");
  glide.age = m.age;
  glide.duration = m.duration;
  glide.jump = m.jump != 0;
  checkSeconds(m.age, "age", false);
  checkSeconds(m.duration, "duration", true);
  for (const ragdoll_msgs::HeldParticle& p : m.held) {
    checkFinite(fromVector3(p.offset), "offset", "[m]");
    if (!std::isfinite(p.age))
      throw Error("age", "is " + numberText(p.age) + "; it must be a finite number [s]");
    glide.held.push_back(
        {findBody(model, p.name).particles.at(0), p.name, fromVector3(p.offset), p.age});
  }
  return followed;
}

std::vector<geometry_msgs::TransformStamped> toTransforms(const FrameTracker& tracker,
                                                          const Posture& posture,
                                                          const std_msgs::Header& header,
                                                          bool roots_only) {
  std::vector<geometry_msgs::TransformStamped> out;
  out.reserve(roots_only ? tracker.ragdolls() : tracker.size());
  for (int i = 0; i < tracker.size(); ++i) {
    const int parent = tracker.parent(i);
    if (roots_only && parent >= 0) continue;
    out.emplace_back();
    out.back().header = header;
    if (parent >= 0) out.back().header.frame_id = tracker.name(parent);
    out.back().child_frame_id = tracker.name(i);
    out.back().transform = toTransform(tracker.local(posture, i));
  }
  return out;
}

void toMarker(const CoatShape& shape, visualization_msgs::Marker& marker) {
  using Type = CoatShape::Type;
  using visualization_msgs::Marker;
  marker.pose = toPose(shape.pose);
  marker.scale = toVector3(shape.size);
  marker.color = toColor(shape.color);
  marker.points.clear();
  marker.colors.clear();
  switch (shape.type) {
    case Type::kBox:
      marker.type = Marker::CUBE;
      return;
    case Type::kSphere:
      marker.type = Marker::SPHERE;
      return;
    case Type::kSpheres:
    case Type::kLines:
      marker.type = shape.type == Type::kLines ? Marker::LINE_LIST : Marker::SPHERE_LIST;
      if (shape.type == Type::kLines) marker.scale.y = marker.scale.z = 0;
      marker.points.reserve(shape.points.cols());
      for (Eigen::Index i = 0; i < shape.points.cols(); ++i)
        marker.points.push_back(toPoint(shape.points.col(i)));
      return;
    case Type::kMesh:
      marker.type = Marker::TRIANGLE_LIST;
      marker.scale = toVector3(Vec3::Ones());
      marker.points.reserve(3 * shape.mesh.triangles.size());
      for (const Triangle& t : shape.mesh.triangles) {
        for (const int v : t) {
          marker.points.push_back(toPoint(shape.mesh.vertices.col(v)));
          if (!shape.mesh.colors.empty()) marker.colors.push_back(toColor(shape.mesh.colors[v]));
        }
      }
      return;
  }
}

}  // namespace ragdoll
