#include "core/direct/runge_kutta.h"

#include <algorithm>
#include <cmath>

#include "core/direct/constants.h"
#include "core/direct/dormand_prince.h"

namespace ragdoll {
namespace {

using namespace dormand_prince;

/// The body's free acceleration at x, v; the power.
double driveBy(const Drive& drive, BodyResponse& body, const double* x, const double* v,
               RungeKuttaScratch& s) {
  const double power = drive(x, v, s.free);
  body.setFree(s.free);
  return power;
}

/// Largest length of a column.
double largest(const double* points, int n) {
  return std::sqrt(Eigen::Map<const Points>(points, 3, n).colwise().squaredNorm().maxCoeff());
}

}  // namespace

double rungeKutta(BodyResponse& body, const double* x, const double* v, const Points& free,
                  const Drive& drive, double h, RungeKuttaScratch& s, Points& dx, Points& v1,
                  double* first_lambda) {
  const StickRows& rows = body.rows();
  const int n = 3 * rows.n, half = paddedWidth(n);
  s.free = free;
  body.setFree(s.free);
  s.start.setZero(2 * half);
  std::copy(x, x + n, s.start.data());
  std::copy(v, v + n, s.start.data() + half);
  s.stage.resize(2 * half);
  s.slopes.setZero(kStages, 2 * half);
  double factors[kStages];
  double work = 0;
  for (int i = 0; i < kStages; ++i) {
    for (int j = 0; j < i; ++j) factors[j] = h * kA[i][j];
    kernels::addWeighted(s.start.data(), s.slopes.data(), factors, i, 2 * half, s.stage.data());
    i == 0 ? body.setStart(s.stage.data()) : body.setEnd(s.stage.data());
    double* slope = s.slopes.row(i).data();
    std::copy(s.stage.data() + half, s.stage.data() + half + n, slope);
    if (drive) work += h * kB[i] * driveBy(drive, body, s.stage.data(), slope, s);
    const Eigen::VectorXd& lambda = body.accelerate(i > 0, slope, slope + half);
    if (i == 0) std::copy(lambda.data(), lambda.data() + rows.s, first_lambda);
  }
  for (int i = 0; i < kStages; ++i) factors[i] = h * kB[i];
  s.start.head(half).setZero();
  kernels::addWeighted(s.start.data(), s.slopes.data(), factors, kStages, 2 * half, s.stage.data());
  dx = Eigen::Map<const Points>(s.stage.data(), 3, rows.n);
  v1 = Eigen::Map<const Points>(s.stage.data() + half, 3, rows.n);
  return work;
}

double rungeKuttaError(BodyResponse& body, const double* x1, const double* v1, const Drive& drive,
                       double h, RungeKuttaScratch& s) {
  const int points = body.rows().n, n = 3 * points, half = paddedWidth(n);
  double* error = s.start.data();
  std::copy(v1, v1 + n, error);
  if (drive) driveBy(drive, body, x1, v1, s);
  body.accelerate(false, v1, error + half);
  s.start *= kE[kStages];
  kernels::addWeighted(error, s.slopes.data(), kE, kStages, 2 * half, error);
  const double rate = std::max(largest(error, points), kSwingTime * largest(error + half, points));
  return h * rate * std::max(1.0, h / kLongFreePart);
}

}  // namespace ragdoll
