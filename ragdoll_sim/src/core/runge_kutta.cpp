#include "ragdoll_sim/core/runge_kutta.h"

#include <algorithm>
#include <cmath>

namespace ragdoll {
namespace {

constexpr int kStages = RungeKuttaScratch::kStages;
constexpr double kA[kStages][kStages - 1] = {
    {},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656}};
constexpr double kB[kStages] = {35.0 / 384,     0,        500.0 / 1113, 125.0 / 192,
                                -2187.0 / 6784, 11.0 / 84};
/// Weights of the fifth order less those of the fourth, the last for the stage at the end.
constexpr double kE[kStages + 1] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                    -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

/// Acceleration at the pose of `sticks` with velocities v; s.pulls: what `free` does to the sticks.
void accelerate(const StickRows& rows, StickSolver& sticks, const double* v, const Points& free,
                RungeKuttaScratch& s, Points& out) {
  s.rates.resize(3, rows.width);
  kernels::multiplyPoints(v, rows.BT.data(), rows.n, rows.width, s.rates.data());
  const Eigen::Map<const PaddedRows> D(sticks.D(), 3, rows.width);
  s.lambda =
      -(D.cwiseProduct(s.pulls).colwise().sum() + s.rates.colwise().squaredNorm()).transpose();
  sticks.solve(rows, s.lambda.data());
  out = free;
  sticks.move(rows, s.lambda.data(), 1, out.data());
}

}  // namespace

void rungeKutta(const StickRows& rows, StickSolver& sticks, const double* x, const double* v,
                const Points& free, double h, RungeKuttaScratch& s, Points& dx, Points& v1,
                double* first_lambda) {
  const Eigen::Map<const Points> x0(x, 3, rows.n), v0(v, 3, rows.n);
  s.free = free;
  s.pulls.resize(3, rows.width);
  kernels::multiplyPoints(free.data(), rows.BT.data(), rows.n, rows.width, s.pulls.data());
  for (int i = 0; i < kStages; ++i) {
    s.x = x0;
    s.v = v0;
    for (int j = 0; j < i; ++j) {
      s.x += h * kA[i][j] * s.dx[j];
      s.v += h * kA[i][j] * s.dv[j];
    }
    sticks.setPose(rows, s.x.data());
    s.dx[i] = s.v;
    accelerate(rows, sticks, s.v.data(), free, s, s.dv[i]);
    if (i == 0)
      for (int k = 0; k < rows.s; ++k) first_lambda[k] = s.lambda[k];
  }
  dx.setZero(3, rows.n);
  v1 = v0;
  for (int i = 0; i < kStages; ++i) {
    dx += h * kB[i] * s.dx[i];
    v1 += h * kB[i] * s.dv[i];
  }
}

double rungeKuttaError(const StickRows& rows, StickSolver& sticks, const double* v1, double h,
                       RungeKuttaScratch& s) {
  accelerate(rows, sticks, v1, s.free, s, s.last_dv);
  s.error = kE[kStages] * Eigen::Map<const Points>(v1, 3, rows.n);
  for (int i = 0; i < kStages; ++i) s.error += kE[i] * s.dx[i];
  const double positions = h * std::sqrt(s.error.colwise().squaredNorm().maxCoeff());
  s.error = kE[kStages] * s.last_dv;
  for (int i = 0; i < kStages; ++i) s.error += kE[i] * s.dv[i];
  return std::max(positions, h * h * std::sqrt(s.error.colwise().squaredNorm().maxCoeff()));
}

}  // namespace ragdoll
