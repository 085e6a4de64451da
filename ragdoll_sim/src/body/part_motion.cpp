#include "ragdoll_sim/body/part_motion.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "body/smoothstep.h"
#include "ragdoll_sim/body/angles.h"

namespace ragdoll {
namespace {

constexpr double kStraight = 0.15;  ///< sine of the bend below which it shows no twist (9 deg)
constexpr double kBent = 0.40;      ///< sine of the bend above which it alone shows it (24 deg)
constexpr double kPole = 0.15;      ///< the reference fades out this near its singular direction
constexpr double kMaxTwist =
    1.9;  ///< [rad] more than this from the reference: hyperextension instead

double wrapped(double angle) { return std::remainder(angle, 2 * M_PI); }

/// Angle about `axis` of a rotation that is a turn about it.
double twistAbout(const Vec3& axis, const Quat& q) {
  return wrapped(2 * std::atan2(q.vec().dot(axis), q.w()));
}

/// A pull towards some twist: by how much, and how sure it is.
struct Pull {
  double angle = 0, confidence = 0;
};

/// 0 at the singular direction of the reference, grows to 1 and more.
double distanceFromPole(const Part& part, const Vec3& d) {
  return part.hinged ? d.cross(part.hinge_axis).squaredNorm()
                     : (1 + d.dot(part.centre_direction)) / 2;
}

Pull pullToReference(const Part& part, const Quat& carried) {
  const Vec3 d = carried * part.rest_direction;
  Pull pull;
  pull.angle = twistAbout(part.rest_direction, carried.conjugate() * referenceOrientation(part, d));
  pull.confidence = smoothstep(0, kPole, distanceFromPole(part, d));
  return pull;
}

/// beyond: unit direction of the bone beyond the hinge, in this bone's frame. A turn about an axis
/// a keeps a . beyond = a . d. With p the unit part of a across d, and beyond = cos(b) d + sin(b)
/// m, that is p . m = (a . d) / |a across d| * tan(b / 2); which m it is of the two the sense of
/// the turn says.
Pull pullToBend(const Part& part, const Vec3& beyond, double to_reference) {
  const Vec3& d = part.rest_direction;
  const double along = part.bend_axis.dot(d);
  const Vec3 across = part.bend_axis - along * d;
  const double sine = d.cross(beyond).norm();
  Pull pull;
  if (across.norm() < 0.1 || sine < 1e-9) return pull;
  const Vec3 p = across.normalized(), m = (beyond - d * d.dot(beyond)) / sine;
  const double tangent = sine / (1 + d.dot(beyond));  // of half the bend
  const double k = std::clamp(along / across.norm() * tangent, -1.0, 1.0);
  const Vec3 expected = k * p - std::sqrt(1 - k * k) * d.cross(p);
  pull.angle = std::atan2(d.dot(expected.cross(m)), expected.dot(m));
  pull.confidence = smoothstep(kStraight, kBent, sine);
  // More twist against the reference than a joint allows: the bend is one to the wrong side.
  if (std::abs(wrapped(pull.angle - to_reference)) > kMaxTwist)
    pull.angle = wrapped(pull.angle + M_PI);
  return pull;
}

Pull blend(const Pull& bend, const Pull& reference) {
  const double rest = (1 - bend.confidence) * reference.confidence;
  Pull pull;
  pull.confidence = bend.confidence + rest;
  if (pull.confidence > 0)
    pull.angle = (bend.confidence * bend.angle + rest * reference.angle) / pull.confidence;
  return pull;
}

}  // namespace

Quat smallestRotation(const Vec3& from, const Vec3& to, const Vec3& fallback) {
  // The half-way vector gives (cos, sin * axis) of half the angle without any trigonometry.
  const double w = 1 + from.dot(to);
  if (w > 1e-12) {
    const Vec3 v = from.cross(to);
    return Quat(w, v.x(), v.y(), v.z()).normalized();
  }
  Vec3 axis = fallback - from * from.dot(fallback);
  if (axis.norm() < 1e-6) axis = from.unitOrthogonal();
  axis.normalize();
  return Quat(0, axis.x(), axis.y(), axis.z());
}

double angleOf(const Quat& q) { return 2 * std::atan2(q.vec().norm(), std::abs(q.w())); }

double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Quat groupOrientation(const Part& part, const Points& rest, const Eigen::Ref<const Points>& x,
                      const Quat& last) {
  const Vec3 rest_mean = partAnchor(part, rest), mean = partAnchor(part, x);
  Eigen::Matrix3d s = Eigen::Matrix3d::Zero();
  for (const int i : part.particles) s += (rest.col(i) - rest_mean) * (x.col(i) - mean).transpose();
  if (!s.allFinite()) return last;

  // [Horn1987, sec. 4.A]: the quaternion is the eigenvector of the largest eigenvalue.
  Eigen::Matrix4d n;
  n << s(0, 0) + s(1, 1) + s(2, 2), s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0),
      s(1, 2) - s(2, 1), s(0, 0) - s(1, 1) - s(2, 2), s(0, 1) + s(1, 0), s(2, 0) + s(0, 2),
      s(2, 0) - s(0, 2), s(0, 1) + s(1, 0), s(1, 1) - s(0, 0) - s(2, 2), s(1, 2) + s(2, 1),
      s(0, 1) - s(1, 0), s(2, 0) + s(0, 2), s(1, 2) + s(2, 1), s(2, 2) - s(0, 0) - s(1, 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(n);
  const auto& value = eigen.eigenvalues();
  if (value[3] - value[2] < 1e-6 * std::abs(value[3]) || value[3] < 1e-18) return last;
  const Eigen::Vector4d v = eigen.eigenvectors().col(3);
  Quat q(v[0], v[1], v[2], v[3]);
  if (q.dot(last) < 0) q.coeffs() = -q.coeffs();
  return q;
}

Vec3 boneDirection(const Part& part, const Eigen::Ref<const Points>& x, const Vec3& last) {
  const Vec3 d = x.col(part.particles[1]) - x.col(part.particles[0]);
  const double length = d.norm();
  return length > kMinLength && std::isfinite(length) ? Vec3(d / length) : last;
}

Vec3 partAnchor(const Part& part, const Eigen::Ref<const Points>& x) {
  if (!part.group) return x.col(part.particles[0]);
  Vec3 mean = Vec3::Zero();
  for (const int i : part.particles) mean += x.col(i);
  return mean / static_cast<double>(part.particles.size());
}

Quat referenceOrientation(const Part& part, const Vec3& d) {
  if (part.hinged) {
    const double angle = hingeAngle(part.hinge_axis, part.straight, d) -
                         hingeAngle(part.hinge_axis, part.straight, part.rest_direction);
    const Quat turn(Eigen::AngleAxisd(angle, part.hinge_axis));
    return smallestRotation(turn * part.rest_direction, d, part.hinge_axis) * turn;
  }
  const Vec3& c = part.centre_direction;
  return smallestRotation(c, d, part.bend_axis) *
         smallestRotation(part.rest_direction, c, part.bend_axis);
}

Quat followBone(const Part& part, const BoneMotion& m, bool free) {
  const Quat before =
      m.parent_before.conjugate() * m.before;  // all in the parent's frame from here
  const Vec3 d_before = before * part.rest_direction;
  const Vec3 d_now = m.parent_now.conjugate() * m.direction;
  const Quat swing = smallestRotation(d_before, d_now, before * part.bend_axis);
  Quat carried = swing * before;

  double motion = angleOf(swing);
  const Pull reference = pullToReference(part, carried);
  Pull pull = reference;
  if (m.bends) {
    const Vec3 beyond_before = m.before.conjugate() * m.beyond_before;
    const Vec3 beyond = (m.parent_now * carried).conjugate() * m.beyond_now;
    motion += angleBetween(beyond_before, beyond);
    pull = blend(pullToBend(part, beyond, reference.angle), reference);
  }
  const double bound = free ? M_PI : kPullGain * motion * pull.confidence;
  const double twist = std::clamp(pull.angle, -bound, bound);
  Quat q = m.parent_now * carried * Quat(Eigen::AngleAxisd(twist, part.rest_direction));

  // Exact direction whatever the rounding of many updates.
  q = (smallestRotation(q * part.rest_direction, m.direction, m.direction) * q).normalized();
  if (q.dot(m.before) < 0) q.coeffs() = -q.coeffs();
  return q;
}

}  // namespace ragdoll
