#include "ragdoll_sim/core/joint_damping.h"

#include <Eigen/Cholesky>

namespace ragdoll {

void dampInnerMotion(const Eigen::MatrixXd& M, const std::vector<int>& pins, double keep,
                     const Eigen::Ref<const Points>& x, Eigen::Ref<Points> v) {
  const Eigen::Index n = x.cols();
  Vec3 centre, drift;
  if (pins.empty()) {
    centre = (x * M).rowwise().sum() / M.sum();
    drift = (v * M).rowwise().sum() / M.sum();
  } else {
    centre = x.col(pins[0]);
    drift = v.col(pins[0]);
  }
  Vec3 spin = Vec3::Zero();
  if (pins.size() < 2) {
    const Points arm = x.colwise() - centre, momentum = (v.colwise() - drift) * M,
                 weighted = arm * M;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    Vec3 angular = Vec3::Zero();
    for (Eigen::Index i = 0; i < n; ++i) {
      const Vec3 r = arm.col(i), w = weighted.col(i);
      angular += r.cross(Vec3(momentum.col(i)));
      inertia += r.dot(w) * Eigen::Matrix3d::Identity() - w * r.transpose();
    }
    // Regular but for bodies on a line, whose own axis takes no spin.
    const double small = 1e-9 * inertia.trace() + 1e-300;
    spin = (inertia + small * Eigen::Matrix3d::Identity()).ldlt().solve(angular);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3 rigid = drift + spin.cross(Vec3(x.col(i) - centre));
    v.col(i) = rigid + keep * (v.col(i) - rigid);
  }
}

}  // namespace ragdoll
