// Dormand-Prince 5 on index-1 equations: accelerations with the sticks' multipliers solved for.
//
// d . d'' + d' . d' = 0 for every stick gives (J W J^T) lambda = -(d . (a B^T) + |d'|^2), and
// x'' = a + D diag(lambda) (B W). Fifth-order weights of [Dormand1980]; the constraints that this
// drifts from are projected back once per step. For smooth motion and as a reference;
// docs/equations.md#rk.
#pragma once

#include <functional>

#include "core/linear/stick_solver.h"

namespace ragdoll {

/// Acceleration without sticks where it is not constant: from positions and velocities (3 x n).
/// Returns a power [W], whose integral is RungeKuttaScratch::work.
using Drive = std::function<double(const double* x, const double* v, Points& free)>;

/// Scratch of one step.
struct RungeKuttaScratch {
  static constexpr int kStages = 6;
  Points free;
  PaddedRows slopes;             ///< a row for each stage: velocities, then accelerations
  Eigen::VectorXd start, stage;  ///< likewise: positions, then velocities
  PaddedRows rates, pulls;
  Eigen::VectorXd lambda;
  double work = 0;  ///< [J] of a Drive
};

/// Motion of one body over h: dx [m] and v1 [m/s] (3 x n, columns) from x, v under the acceleration
/// `free`, or `drive` if there is one, that it would have without sticks. first_lambda (s):
/// multipliers at the start, whose pose `start` holds or is given; `sticks` takes those of the
/// stages.
void rungeKutta(const StickRows& rows, StickSolver& start, StickSolver& sticks, const double* x,
                const double* v, const Points& free, const Drive& drive, double h,
                RungeKuttaScratch& scratch, Points& dx, Points& v1, double* first_lambda);

/// [m] Estimate of the error that the last rungeKutta made over h: the largest distance of a
/// particle, or of kSwingTime times its velocity, from the embedded motion of fourth order
/// [Dormand1980].
/// `sticks`, x1 and v1: of the motion's end; scratch: as rungeKutta left it.
double rungeKuttaError(const StickRows& rows, StickSolver& sticks, const double* x1,
                       const double* v1, const Drive& drive, double h, RungeKuttaScratch& scratch);

}  // namespace ragdoll
