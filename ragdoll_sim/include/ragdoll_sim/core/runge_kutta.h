// Dormand-Prince 5 on index-1 equations: accelerations with the sticks' multipliers solved for.
//
// d . d'' + d' . d' = 0 for every stick gives (J W J^T) lambda = -(d . (a B^T) + |d'|^2), and
// x'' = a + D diag(lambda) (B W). Fifth-order weights of [Dormand1980]; the constraints that this
// drifts from are projected back once per step. For smooth motion and as a reference;
// docs/equations.md#rk.
#pragma once

#include <array>

#include "ragdoll_sim/core/stick_solver.h"

namespace ragdoll {

/// Scratch of one step.
struct RungeKuttaScratch {
  static constexpr int kStages = 6;
  Points x, v;
  std::array<Points, kStages> dx, dv;
  PaddedRows rates, pulls;
  Eigen::VectorXd lambda;
};

/// Motion of one body over h: dx [m] and v1 [m/s] (3 x n, columns) from x, v under the acceleration
/// `free` that it would have without sticks. first_lambda (s): multipliers at the start.
void rungeKutta(const StickRows& rows, StickSolver& sticks, const double* x, const double* v,
                const Points& free, double h, RungeKuttaScratch& scratch, Points& dx, Points& v1,
                double* first_lambda);

}  // namespace ragdoll
