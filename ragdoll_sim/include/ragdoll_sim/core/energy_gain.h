// What a body gained in a motion beyond the work of gravity, in one product with its mass matrix.
#pragma once

#include "ragdoll_sim/core/types.h"

namespace ragdoll {

struct EnergyGainScratch {
  Eigen::Matrix<double, Eigen::Dynamic, 4> change, pushed;
};

/// [J] of kinetic energy from v0 to v1 less gravity's work along `moved` (3 x n each). The
/// difference of the two energies as (v1 - v0) M (v1 + v0) / 2, which rounds less than either.
template <class V0, class V1>
double energyGain(const Eigen::MatrixXd& M, const V0& v0, const V1& v1, const Points& moved,
                  const Vec3& gravity, EnergyGainScratch& s) {
  s.change.resize(M.rows(), 4);
  s.change.leftCols<3>() = (v1 - v0).transpose();
  s.change.col(3).noalias() = moved.transpose() * gravity;
  s.pushed.resize(M.rows(), 4);
  s.pushed.noalias() = M.lazyProduct(s.change);
  return 0.5 * s.pushed.leftCols<3>().transpose().cwiseProduct(v0 + v1).sum() -
         s.pushed.col(3).sum();
}

}  // namespace ragdoll
