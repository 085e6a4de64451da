// A body's sticks in a step of backward Euler: Newton's method for positions and multipliers
// together, with the tension's stiffness in its matrix (docs/equations.md#guard).
#pragma once

#include <Eigen/LU>

#include "core/linear/stick_kernels.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// What it works with, so that not each step allocates it anew.
struct ImplicitSticks {
  Points free;             ///< [m] 3 x n: the motion without the sticks
  Points dx;               ///< [m] 3 x n: with them
  Eigen::VectorXd lambda;  ///< [kg] impulses of the sticks times h: to begin with, and found
  Points unbalanced, step;
  Eigen::MatrixXd D0, D, impulses, DB, tangent, sides, solved, pulled, system, turn;
  PaddedRows turned_pulls;  ///< as the solution of a transposed right-hand side lies in memory
  Eigen::VectorXd stretch, change, solution;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu;
};

/// Gives what is in it its size.
void makeRoom(const DirectSystem& system, ImplicitSticks& s);

/// s.dx and s.lambda of a motion from x (3 x n) after which sticks have these squared lengths.
/// False: none was found.
bool moveImplicitly(const DirectSystem& system, const double* length2,
                    const Eigen::Ref<const Points>& x, ImplicitSticks& s);

}  // namespace ragdoll
