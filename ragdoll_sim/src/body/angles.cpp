#include "ragdoll_sim/body/angles.h"

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/direction.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {
namespace {

char axisLetter(const Vec3& axis) {
  int largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return "xyz"[largest];
}

/// x: coordinates of the body's first particle.
double bendAngle(const JointFrames::Bend& bend, const double* x) {
  const Vec3 u = valueOf(bend.parent, x), w = valueOf(bend.child, x);
  const double between = std::atan2(u.cross(w).norm(), u.dot(w));
  // Backwards: on the wrong side by more than half of what is bent. A limit keeps its child on the
  // right side, but the plane of bending may lie along the border.
  const bool back = bend.sided && w.dot(valueOf(bend.forward, x)) < -std::sin(between / 2);
  return (back ? -bend.side : bend.side) * turnOfBend(between, bend.sine);
}

}  // namespace

double hingeAngle(const Vec3& axis, const Vec3& parent, const Vec3& child) {
  const Vec3 a = parent - axis * axis.dot(parent), b = child - axis * axis.dot(child);
  return std::atan2(axis.dot(a.cross(b)), a.dot(b));
}

Vec3 jointEuler(const Quat& q) {
  // R = Ry Rx Rz: R(1,2) = -sin x; R(0,2) = cos x sin y; R(1,0) = cos x sin z; and so on.
  const Eigen::Matrix3d r = q.toRotationMatrix();
  const double cosine = std::hypot(r(0, 2), r(2, 2));
  const double x = std::atan2(-r(1, 2), cosine);
  if (cosine < 1e-9) return {x, std::atan2(-r(2, 0), r(0, 0)), 0};  // locked: all of it is y
  return {x, std::atan2(r(0, 2), r(2, 2)), std::atan2(r(1, 0), r(1, 1))};
}

Quat fromJointEuler(const Vec3& xyz) {
  return Quat(Eigen::AngleAxisd(xyz.y(), Vec3::UnitY()) *
              Eigen::AngleAxisd(xyz.x(), Vec3::UnitX()) *
              Eigen::AngleAxisd(xyz.z(), Vec3::UnitZ()));
}

HingeGeometry hingeGeometry(const Skeleton& skeleton, const Joint& joint) {
  const auto direction = [&](const Segment& segment) {
    return Vec3((skeleton.rest.col(segment.particles[1]) - skeleton.rest.col(segment.particles[0]))
                    .normalized());
  };
  const Segment& parent = skeleton.segments[joint.parent];
  const Segment& child = skeleton.segments[joint.child];
  HingeGeometry g;
  g.axis = joint.axis.normalized();
  g.child = child.group ? g.axis.unitOrthogonal() : direction(child);
  g.straight = child.group || parent.group ? g.child : direction(parent);
  return g;
}

JointAngles::JointAngles(const Model& model, const FrameTracker& tracker) {
  for (std::size_t r = 0; r < model.ragdolls.size(); ++r) {
    const Ragdoll& ragdoll = model.ragdolls[r];
    const Skeleton& skeleton = model.skeletonOf(ragdoll);
    const FrameTree& tree = tracker.tree(static_cast<int>(r));
    const int first = tracker.firstPart(static_cast<int>(r));
    for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
      const Joint& joint = skeleton.joints[j];
      Entry entry;
      entry.parent = tree.partOf(skeleton.segments[joint.parent]);
      entry.child = tree.partOf(skeleton.segments[joint.child]);
      if (entry.parent < 0 || entry.child < 0) continue;
      entry.parent += first;
      entry.child += first;
      entry.particle = ragdoll.first;
      add(skeleton, static_cast<int>(j), r == 0 ? "" : ragdoll.name + "/", std::move(entry));
    }
  }
}

void JointAngles::add(const Skeleton& skeleton, int j, const std::string& prefix, Entry entry) {
  const Joint& joint = skeleton.joints[j];
  const std::string name = prefix + joint.name + "_";
  const bool on_bone = !skeleton.segments[joint.parent].group;
  if (joint.type == JointSpec::Type::kHinge) {
    if (on_bone && !skeleton.segments[joint.child].group)
      entry.bend = JointFrames(skeleton).bend(j);
    else
      entry.hinge = hingeGeometry(skeleton, joint);
    names_.push_back(name + axisLetter(joint.axis));
    entries_.push_back(std::move(entry));
    return;
  }
  const auto of_joint = [&](const auto& limit) { return limit.joint == j; };
  if (joint.type == JointSpec::Type::kCone) {
    const auto& all = skeleton.limits;
    const auto it = std::find_if(all.begin(), all.end(), of_joint);
    if (it != all.end()) entry.cone = *it;
  } else {
    const auto& all = skeleton.plane_limits;
    const auto it = std::find_if(all.begin(), all.end(), of_joint);
    if (it != all.end()) entry.planes = *it;
  }
  const auto regions =
      std::count_if(joint.planes.begin(), joint.planes.end(), [](const auto& p) { return !!p; });
  entry.euler = !(entry.planes && on_bone && regions < 3);
  if (entry.euler)
    for (const char* letter : {"x", "y", "z"}) names_.push_back(name + letter);
  if (entry.cone) names_.push_back(name + "swing");
  static const char* const kPlanes[] = {"xy", "yz", "xz"};
  for (int k = 0; k < 3; ++k)
    if (entry.planes && entry.planes->regions[k].used) names_.push_back(name + kPlanes[k]);
  entries_.push_back(std::move(entry));
}

void JointAngles::compute(const Posture& posture, std::vector<double>& angles) const {
  angles.clear();
  for (const Entry& entry : entries_) {
    const double* x = posture.x.data() + 3 * entry.particle;
    const Quat turn = posture.parts[entry.parent].conjugate() * posture.parts[entry.child];
    if (entry.bend) angles.push_back(bendAngle(*entry.bend, x));
    if (entry.hinge)
      angles.push_back(
          hingeAngle(entry.hinge->axis, entry.hinge->straight, turn * entry.hinge->child));
    if (entry.euler) {
      const Vec3 xyz = jointEuler(turn);
      angles.insert(angles.end(), xyz.data(), xyz.data() + 3);
    }
    if (entry.cone) angles.push_back(entry.cone->angle - limitValue(*entry.cone, x));
    if (!entry.planes) continue;
    const Vec3 d = childInParent(*entry.planes, x);
    for (const PlaneLimit::Region& region : entry.planes->regions)
      if (region.used) angles.push_back(regionAngle(region, d));
  }
}

}  // namespace ragdoll
