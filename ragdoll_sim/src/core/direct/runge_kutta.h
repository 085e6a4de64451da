// Dormand-Prince 5 on index-1 equations: accelerations with the sticks' multipliers solved for.
//
// d . d'' + d' . d' = 0 for every stick gives (J W J^T) lambda = -(d . (a B^T) + |d'|^2), and
// x'' = a + D diag(lambda) (B W). Fifth-order weights of [Dormand1980]; the constraints that this
// drifts from are projected back once per step. For smooth motion and as a reference;
// docs/equations.md#rk.
#pragma once

#include <functional>

#include "core/linear/body_response.h"

namespace ragdoll {

/// Acceleration without sticks where it is not constant: from positions and velocities (3 x n).
/// Returns a power [W].
using Drive = std::function<double(const double* x, const double* v, Points& free)>;

/// Scratch of one step.
struct RungeKuttaScratch {
  Points free;
  PaddedRows slopes;             ///< a row for each stage: velocities, then accelerations
  Eigen::VectorXd start, stage;  ///< likewise: positions, then velocities
};

/// Motion of one body over h: dx [m] and v1 [m/s] (3 x n, columns) from x, v under the acceleration
/// `free`, or `drive` if there is one, that it would have without sticks. first_lambda (s):
/// multipliers at the start, where the body's start is afterwards; its end is at a stage. Returns
/// the integral of the drive's power [J].
double rungeKutta(BodyResponse& body, const double* x, const double* v, const Points& free,
                  const Drive& drive, double h, RungeKuttaScratch& scratch, Points& dx, Points& v1,
                  double* first_lambda);

/// [m] Estimate of the error that the last rungeKutta made over h: the largest distance of a
/// particle, or of kSwingTime times its velocity, from the embedded motion of fourth order
/// [Dormand1980]; more for parts above kLongFreePart.
/// x1 and v1: of the motion's end, where the body's start is; scratch: as rungeKutta left it.
double rungeKuttaError(BodyResponse& body, const double* x1, const double* v1, const Drive& drive,
                       double h, RungeKuttaScratch& scratch);

}  // namespace ragdoll
