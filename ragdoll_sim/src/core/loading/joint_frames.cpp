#include "ragdoll_sim/core/joint_frames.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/direction.h"

namespace ragdoll {
namespace {

constexpr double kParallelSine = 1e-3;  ///< [-] sine below which directions count as parallel

}  // namespace

double bendOfTurn(double turn, double sine) {
  return 2 * std::asin(std::min(1.0, sine * std::sin(turn / 2)));
}

double turnOfBend(double bend, double sine) {
  return 2 * std::asin(std::min(1.0, std::sin(bend / 2) / sine));
}

Vec3 turned(double angle, const Vec3& axis, const Vec3& v) {
  return Eigen::AngleAxisd(angle, axis) * v;
}

int JointFrames::shared(const Segment& a, const Segment& b) {
  for (const int i : a.particles)
    if (std::count(b.particles.begin(), b.particles.end(), i)) return i;
  return -1;
}

int JointFrames::jointAbove(int segment) const {
  for (std::size_t j = 0; j < s_.joints.size(); ++j)
    if (s_.joints[j].child == segment) return static_cast<int>(j);
  return -1;
}

int JointFrames::parentOf(int segment) const {
  const int joint = jointAbove(segment);
  if (joint >= 0) return s_.joints[joint].parent;
  for (std::size_t g = 0; g < s_.segments.size(); ++g)
    if (s_.segments[g].group && shared(s_.segments[g], s_.segments[segment]) >= 0)
      return static_cast<int>(g);
  return -1;
}

std::pair<int, int> JointFrames::boneFrom(int segment, int other) const {
  const std::vector<int>& p = s_.segments[segment].particles;
  const bool turn = other >= 0 && shared(s_.segments[segment], s_.segments[other]) == p[1];
  return turn ? std::pair(p[1], p[0]) : std::pair(p[0], p[1]);
}

std::pair<int, int> JointFrames::parentBone(int parent, int child) const {
  const std::vector<int>& p = s_.segments[parent].particles;
  const bool turn = shared(s_.segments[parent], s_.segments[child]) == p[0];
  return turn ? std::pair(p[1], p[0]) : std::pair(p[0], p[1]);
}

Vec3 JointFrames::restDirection(const std::pair<int, int>& bone) const {
  return (s_.rest.col(bone.second) - s_.rest.col(bone.first)).normalized();
}

Direction JointFrames::boneAlong(const std::pair<int, int>& bone) {
  Direction d;
  d.bone = true;
  d.base = {bone.first, bone.second, bone.second};
  return d;
}

bool JointFrames::triangle(const Segment& group, std::array<int, 3>& best) const {
  const std::vector<int>& p = group.particles;
  double largest = 0, size = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = i + 1; j < p.size(); ++j) {
      const Vec3 e = s_.rest.col(p[j]) - s_.rest.col(p[i]);
      size = std::max(size, e.squaredNorm());
      for (std::size_t k = j + 1; k < p.size(); ++k) {
        const double area = e.cross(Vec3(s_.rest.col(p[k]) - s_.rest.col(p[i]))).norm();
        if (area <= 1.000001 * largest) continue;  // mirror images differ by rounding only
        largest = area;
        best = {p[i], p[j], p[k]};
      }
    }
  return largest > kParallelSine * size;
}

Vec3 JointFrames::coefficients(const std::array<int, 3>& base, const Vec3& v) const {
  Eigen::Matrix3d A;
  A.col(0) = s_.rest.col(base[1]) - s_.rest.col(base[0]);
  A.col(1) = s_.rest.col(base[2]) - s_.rest.col(base[0]);
  A.col(2) = A.col(0).cross(A.col(1));
  return A.inverse() * v;
}

Vec3 JointFrames::centre(int segment) const {
  const int j = jointAbove(segment), parent = parentOf(segment);
  const Vec3 rest = restDirection(boneFrom(segment, parent));
  if (j < 0) return rest;
  const Joint& joint = s_.joints[j];
  Vec3 centre = rest;
  if (joint.type == JointSpec::Type::kCone) centre = joint.axis;
  if (joint.type == JointSpec::Type::kHinge)
    centre = turned((joint.range.begin + joint.range.end) / 2, joint.axis, hingeZero(j));
  if (joint.type == JointSpec::Type::kPlanes) centre = meanAllowed(j, rest);
  return 1 + centre.dot(rest) > kParallelSine ? centre : rest;
}

Vec3 JointFrames::hingeZero(int j) const {
  const Joint& joint = s_.joints[j];
  if (!s_.segments[joint.parent].group) return restDirection(parentBone(joint.parent, joint.child));
  const Vec3 w = childRest(j);
  return (w - joint.axis.dot(w) * joint.axis).normalized();
}

JointFrames::Bend JointFrames::bend(int j) const {
  const Joint& joint = s_.joints[j];
  const std::pair<int, int> parent = parentBone(joint.parent, joint.child);
  const Vec3 across = joint.axis.normalized().cross(restDirection(parent));
  Bend bend;
  bend.parent = boneAlong(parent);
  bend.child = boneAlong(boneFrom(joint.child, joint.parent));
  // The mirrored hinge has the same angles with other signs: let it bend the way it bends most.
  bend.side = -joint.range.begin > joint.range.end ? -1 : 1;
  bend.sine = across.norm();
  bend.sided = fixedIn(joint.parent, bend.side * across.normalized(), bend.forward);
  return bend;
}

bool JointFrames::fixedIn(int segment, const Vec3& rest, Direction& d, int depth) const {
  const Segment& g = s_.segments[segment];
  if (g.group) {
    if (!triangle(g, d.base)) return false;
    d.c = coefficients(d.base, rest);
    d.swings = 0;
    return true;
  }
  const int parent = parentOf(segment);
  if (parent < 0 || depth == Direction::kMaxSwings) return false;
  const std::pair<int, int> bone = boneFrom(segment, parent);
  const Vec3 middle = centre(segment);
  Direction start;
  if (!fixedIn(parent, middle, start, depth + 1)) return false;
  if (!fixedIn(parent, swung(restDirection(bone), middle, rest), d, depth + 1)) return false;
  if (d.swings == Direction::kMaxSwings) return false;
  d.swing[d.swings++] = {bone.first, bone.second, start.c};
  return true;
}

Vec3 JointFrames::childRest(int j) const {
  const Joint& joint = s_.joints[j];
  const Segment& child = s_.segments[joint.child];
  if (!child.group) return restDirection(boneFrom(joint.child, joint.parent));
  const Segment& parent = s_.segments[joint.parent];
  Vec3 near = Vec3::Zero(), far = Vec3::Zero();
  int count = 0;
  for (const int i : child.particles) {
    const bool common = std::count(parent.particles.begin(), parent.particles.end(), i) > 0;
    (common ? near : far) += s_.rest.col(i);
    count += common;
  }
  const int others = static_cast<int>(child.particles.size()) - count;
  Vec3 w = far / std::max(others, 1) - near / std::max(count, 1);
  w -= joint.axis.dot(w) * joint.axis;
  return w.norm() > kMinLength ? Vec3(w.normalized()) : Vec3(joint.axis.unitOrthogonal());
}

PlaneLimit JointFrames::planes(int j) const {
  const Joint& joint = s_.joints[j];
  PlaneLimit limit;
  limit.joint = j;
  limit.child = boneAlong(boneFrom(joint.child, joint.parent));
  if (std::isfinite(joint.stiffness)) limit.compliance = 1 / joint.stiffness;
  limit.damping = joint.damping;
  const bool left = s_.rest(1, limit.child.base[0]) > kMinLength;
  const bool bone_parent = !s_.segments[joint.parent].group;
  for (int k = 0; k < 3; ++k)
    if (joint.planes[k])
      limit.regions[k] = planeRegion(limitPlane(k, left, bone_parent), *joint.planes[k]);
  return limit;
}

Vec3 JointFrames::meanAllowed(int j, const Vec3& rest) const {
  constexpr int kSamples = 2000;
  const PlaneLimit limit = planes(j);
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < kSamples; ++i) {  // a spiral of equal areas from pole to pole
    const double z = 1 - (2 * i + 1.0) / kSamples, r = std::sqrt(1 - z * z);
    const double angle = M_PI * (3 - std::sqrt(5.0)) * i;
    const Vec3 d(r * std::cos(angle), r * std::sin(angle), z);
    if (isAllowed(limit, d)) sum += d;
  }
  return sum.norm() > 1e-2 * kSamples ? Vec3(sum.normalized()) : rest;
}

}  // namespace ragdoll
