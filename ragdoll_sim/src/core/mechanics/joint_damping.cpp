#include "core/mechanics/joint_damping.h"

#include <Eigen/Cholesky>

namespace ragdoll {

void Turning::add(const MassMatrix& mass, const Eigen::Ref<const Points>& x,
                  const Eigen::Ref<const Points>& v, const RigidMotion& motion) {
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vec3 r = x.col(i) - motion.centre;
    Vec3 w = Vec3::Zero();
    for (Eigen::Index j = 0; j < x.cols(); ++j)  // M is sparse
      if (mass.M(j, i) != 0) w += mass.M(j, i) * (x.col(j) - motion.centre);
    angular += w.cross(Vec3(v.col(i) - motion.drift));
    inertia += r.dot(w) * Eigen::Matrix3d::Identity() - w * r.transpose();
  }
}

Vec3 Turning::spin() const {
  // Regular but for bodies on a line, whose own axis takes no spin.
  const double small = 1e-13 * inertia.trace() + 1e-300;
  return (inertia + small * Eigen::Matrix3d::Identity()).ldlt().solve(angular);
}

RigidMotion rigidMotion(const MassMatrix& mass, const std::vector<int>& pins,
                        const Eigen::Ref<const Points>& x, const Eigen::Ref<const Points>& v) {
  RigidMotion motion;
  if (pins.empty()) {
    motion.centre = x.lazyProduct(mass.sums) / mass.sums.sum();
    motion.drift = v.lazyProduct(mass.sums) / mass.sums.sum();
  } else {
    motion.centre = x.col(pins[0]);
    motion.drift = v.col(pins[0]);
  }
  if (pins.size() >= 2) return motion;
  Turning turning;
  turning.add(mass, x, v, motion);
  motion.spin = turning.spin();
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
