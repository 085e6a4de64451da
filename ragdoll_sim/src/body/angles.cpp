#include "ragdoll_sim/body/angles.h"

#include <cmath>

#include "ragdoll_sim/core/direction.h"

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
    const std::string prefix = r == 0 ? "" : ragdoll.name + "/";
    for (const Joint& joint : skeleton.joints) {
      const int parent = tree.partOf(skeleton.segments[joint.parent]);
      const int child = tree.partOf(skeleton.segments[joint.child]);
      if (parent < 0 || child < 0) continue;
      const bool hinge = joint.type == JointSpec::Type::kHinge;
      const int first = tracker.firstPart(static_cast<int>(r));
      entries_.push_back({hinge, first + parent, first + child,
                          hinge ? hingeGeometry(skeleton, joint) : HingeGeometry(), std::nullopt,
                          ragdoll.first});
      const int j = static_cast<int>(&joint - skeleton.joints.data());
      if (hinge && !skeleton.segments[joint.parent].group && !skeleton.segments[joint.child].group)
        entries_.back().bend = JointFrames(skeleton).bend(j);
      const std::string letters = hinge ? std::string(1, axisLetter(joint.axis)) : "xyz";
      for (const char letter : letters) names_.push_back(prefix + joint.name + "_" + letter);
    }
  }
}

void JointAngles::compute(const Posture& posture, std::vector<double>& angles) const {
  angles.clear();
  for (const Entry& entry : entries_) {
    const Quat turn = posture.parts[entry.parent].conjugate() * posture.parts[entry.child];
    if (entry.bend) {
      angles.push_back(bendAngle(*entry.bend, posture.x.data() + 3 * entry.particle));
    } else if (entry.hinge) {
      angles.push_back(
          hingeAngle(entry.geometry.axis, entry.geometry.straight, turn * entry.geometry.child));
    } else {
      const Vec3 xyz = jointEuler(turn);
      angles.insert(angles.end(), xyz.data(), xyz.data() + 3);
    }
  }
}

}  // namespace ragdoll
