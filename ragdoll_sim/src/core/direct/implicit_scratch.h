// What an implicit step works with, so that not each allocates it anew.
#pragma once

#include <Eigen/LU>

#include "core/linear/stick_kernels.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll {

struct ImplicitScratch {
  Points free, dx, unbalanced, step;
  Eigen::MatrixXd D0, D, impulses, DB, tangent, sides, solved, pulled, system, turn;
  PaddedRows turned_pulls;  ///< as the solution of a transposed right-hand side lies in memory
  Eigen::VectorXd lambda, stretch, change, solution;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu;
};

}  // namespace ragdoll
