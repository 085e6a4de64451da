#include "core/mechanics/joint_damping.h"

#include <Eigen/Eigenvalues>

namespace ragdoll {
namespace {

constexpr double kSingular = 1e-13;   ///< of the inertia's trace
constexpr double kNoInertia = 1e-10;  ///< of the largest: of what lies in a line, about it
constexpr double kInLine = 1e-6;      ///< [-] sine below which pins are on one line
constexpr double kAtOne = 1e-6;  ///< of the body's reach: pins nearer than that are at one place
constexpr double kRigid = 1e-6;  ///< of their speeds: how far pins move as one rigid body

/// The spin that two or more pins have, but for that about `axis`, the line through them, which is
/// free. False: no rigid motion has theirs, none is free, or they are at one place, to which only
/// what pulls a body together brings them.
bool spinByPins(const std::vector<int>& pins, const Eigen::Ref<const Points>& x,
                const Eigen::Ref<const Points>& v, Vec3& axis, Vec3& spin) {
  int farthest = pins[0];
  const auto arm = [&](int p) { return Vec3(x.col(p) - x.col(pins[0])); };
  const auto rate = [&](int p) { return Vec3(v.col(p) - v.col(pins[0])); };
  for (const int p : pins)
    if (arm(p).squaredNorm() > arm(farthest).squaredNorm()) farthest = p;
  const Vec3 line = arm(farthest);
  const double reach = (x.colwise() - x.col(pins[0])).colwise().norm().maxCoeff();
  if (line.norm() <= kAtOne * reach) return false;
  const Vec3 turn = line.cross(rate(farthest)) / line.squaredNorm();
  for (const int p : pins) {
    if (arm(p).cross(line).norm() > kInLine * line.squaredNorm()) return false;
    if ((rate(p) - turn.cross(arm(p))).norm() > kRigid * rate(farthest).norm()) return false;
  }
  axis = line.normalized();
  spin = turn;
  return true;
}

/// L D L^T of an inertia: symmetric and not negative, so that no pivot need be chosen.
struct GuardedInertia {
  double d[3], xy, xz, yz;

  explicit GuardedInertia(const Eigen::Matrix3d& inertia) {
    const double small = kSingular * inertia.trace() + 1e-300;
    d[0] = 1 / (inertia(0, 0) + small);
    xy = inertia(1, 0) * d[0];
    xz = inertia(2, 0) * d[0];
    d[1] = 1 / (inertia(1, 1) + small - xy * inertia(1, 0));
    const double rest = inertia(2, 1) - xz * inertia(1, 0);
    yz = rest * d[1];
    d[2] = 1 / (inertia(2, 2) + small - xz * inertia(2, 0) - yz * rest);
  }
  Vec3 solve(const Vec3& b) const {
    const double y = b[1] - xy * b[0], z = b[2] - xz * b[0] - yz * y;
    Vec3 x;
    x[2] = d[2] * z;
    x[1] = d[1] * y - yz * x[2];
    x[0] = d[0] * b[0] - xy * x[1] - xz * x[2];
    return x;
  }
};

}  // namespace

Rotation rotationOf(const MassMatrix& mass, const Eigen::Ref<const Points>& x,
                    const Eigen::Ref<const Points>& v, const RigidMotion& motion) {
  Points& arms = mass.scratch.change;
  arms = x.colwise() - motion.centre;
  const auto weighted = momentum(mass.rows, mass.scratch);  // arms times M
  Rotation rotation;
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vec3 w = weighted.col(i);
    rotation.angular += w.cross(Vec3(v.col(i) - motion.drift));
    second += w * arms.col(i).transpose();
  }
  rotation.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return rotation;
}

Vec3 angularOf(const MassMatrix& mass, const Eigen::Ref<const Points>& x,
               const Eigen::Ref<const Points>& v, const RigidMotion& motion) {
  mass.scratch.change = x.colwise() - motion.centre;
  const auto weighted = momentum(mass.rows, mass.scratch);
  Vec3 angular = Vec3::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    angular += Vec3(weighted.col(i)).cross(Vec3(v.col(i) - motion.drift));
  return angular;
}

Vec3 spinOf(const Eigen::Matrix3d& inertia, const Vec3& angular) {
  return GuardedInertia(inertia).solve(angular);
}

Vec3 exactSpinOf(const Eigen::Matrix3d& inertia, const Vec3& angular) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(inertia);
  Vec3 spin = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = axes.eigenvectors().col(k);
    if (axes.eigenvalues()[k] > kNoInertia * axes.eigenvalues()[2])
      spin += axis.dot(angular) / axes.eigenvalues()[k] * axis;
  }
  return spin;
}

RigidMotion driftOf(const MassMatrix& mass, const Eigen::Ref<const Points>& x,
                    const Eigen::Ref<const Points>& v) {
  const double total = mass.rows.mass.sum();
  RigidMotion motion;
  motion.centre = x.lazyProduct(mass.rows.mass) / total;
  motion.drift = v.lazyProduct(mass.rows.mass) / total;
  return motion;
}

RigidMotion rigidMotion(const MassMatrix& mass, const std::vector<int>& pins,
                        const Eigen::Ref<const Points>& x, const Eigen::Ref<const Points>& v) {
  RigidMotion motion;
  if (pins.empty()) {
    motion = driftOf(mass, x, v);
  } else {
    motion.centre = x.col(pins[0]);
    motion.drift = v.col(pins[0]);
  }
  Vec3 axis = Vec3::Zero();
  if (pins.size() >= 2 && !spinByPins(pins, x, v, axis, motion.spin)) return motion;
  const Rotation rotation = rotationOf(mass, x, v, motion);
  if (pins.size() < 2) {
    motion.spin = spinOf(rotation.inertia, rotation.angular);
  } else {
    const Eigen::Matrix3d& inertia = rotation.inertia;
    motion.spin += axis.dot(rotation.angular - inertia * motion.spin) /
                   (axis.dot(inertia * axis) + kSingular * inertia.trace() + 1e-300) * axis;
  }
  return motion;
}

void dampInnerMotion(const MassMatrix& mass, const std::vector<int>& pins, double keep,
                     const Eigen::Ref<const Points>& x, Eigen::Ref<Points> v) {
  const RigidMotion motion = rigidMotion(mass, pins, x, v);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vec3 rigid = motion.velocityAt(x.col(i));
    v.col(i) = rigid + keep * (v.col(i) - rigid);
  }
}

}  // namespace ragdoll
