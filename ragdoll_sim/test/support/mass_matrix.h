// The mass matrix of particles that no stick joins, as the mechanics take it.
#pragma once

#include <Eigen/LU>

#include "core/mechanics/joint_damping.h"

namespace ragdoll::test {

class LooseMasses {
 public:
  /// M: [kg] n x n.
  explicit LooseMasses(const Eigen::MatrixXd& M) : rows_(system(M), M) {}

  MassMatrix matrix() { return {rows_, scratch_}; }
  const Eigen::VectorXd& sums() const { return rows_.mass; }  ///< [kg] n, of M's rows

 private:
  static DirectSystem system(const Eigen::MatrixXd& M) {
    DirectSystem loose;
    loose.B.resize(0, M.cols());
    loose.BW.resize(0, M.cols());
    loose.W = M.inverse();
    return loose;
  }

  StickRows rows_;
  EnergyScratch scratch_;
};

}  // namespace ragdoll::test
