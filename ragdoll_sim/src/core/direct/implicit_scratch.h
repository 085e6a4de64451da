// What an implicit step works with, so that not each allocates it anew.
#pragma once

#include <Eigen/LU>

#include "ragdoll_sim/core/types.h"

namespace ragdoll {

struct ImplicitScratch {
  Points free, dx, unbalanced, step;
  Eigen::MatrixXd D0, D, impulses, DB, tangent, sides, solved, pulled, system, turn;
  Eigen::VectorXd lambda, stretch, change;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu;
};

}  // namespace ragdoll
