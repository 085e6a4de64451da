#include "core/linear/stick_solver.h"

#include <algorithm>
#include <cstring>

#include "core/linear/constants.h"

namespace ragdoll {
namespace {

constexpr double kPivotFloor =
    1e-12;  ///< of the diagonal: below, sticks are dependent in this pose

PaddedRows padded(const Eigen::MatrixXd& m) {
  PaddedRows out = PaddedRows::Zero(m.rows(), paddedWidth(static_cast<int>(m.cols())));
  out.leftCols(m.cols()) = m;
  return out;
}

}  // namespace

StickRows::StickRows(const DirectSystem& d, const Eigen::MatrixXd& masses)
    : n(static_cast<int>(d.B.cols())),
      s(static_cast<int>(d.B.rows())),
      width(paddedWidth(s)),
      columns(paddedWidth(n)),
      BT(padded(d.B.transpose())),
      G(padded(d.G)),
      BW(padded(d.BW)),
      absolute_G(G.cwiseAbs()),
      M(padded(masses)),
      mass(masses.rowwise().sum()),
      coordinates(paddedWidth(3 * n)),
      spread_W(PaddedRows::Zero(n, coordinates)),
      WBT(padded(d.BW.transpose())),
      spread_BW(PaddedRows::Zero(s, coordinates)),
      length2(Eigen::VectorXd::Zero(width)),
      inverse_length2(Eigen::VectorXd::Zero(width)) {
  for (int j = 0; j < n; ++j)
    for (int c = 0; c < 3; ++c) {
      spread_BW.col(3 * j + c) = d.BW.col(j);
      spread_W.col(3 * j + c) = d.W.col(j);
    }
  length2.head(s) = d.length.cwiseAbs2();
  inverse_length2.head(s) = length2.head(s).cwiseInverse();
  if (s > 0) shortest = d.length.minCoeff();
  if (s > 0) largest_row = absolute_G.rowwise().sum().maxCoeff();
  if (s > 0) scale = std::min(1.0, d.length.mean() / kHumanStick);
}

void StickSolver::resize(const StickRows& rows) {
  if (D_.cols() == rows.width && inverse_.cols() == rows.width && pose_.size() == 3 * rows.n)
    return;
  D_.setZero(3, rows.width);
  rates_.setZero(3, rows.width);
  inverse_.setZero(rows.s + rows.s % 2, rows.width);
  moved_.setZero(3, rows.columns);
  solved_.setZero(rows.width);
  work_.setZero(rows.width);
  lambda_.setZero(rows.width);
  pulls_.setZero(3, rows.s);
  pose_.setZero(3 * rows.n);
  across_.setZero(rows.s, rows.coordinates);
  mobility_.setZero(3 * rows.n, rows.coordinates);
  has_mobility_.assign(rows.n, 0);
  valid_ = has_across_ = false;
}

void StickSolver::setPose(const StickRows& rows, const double* x) {
  const std::size_t bytes = sizeof(double) * 3 * rows.n;
  if (valid_ && std::memcmp(pose_.data(), x, bytes) == 0) return;
  std::memcpy(pose_.data(), x, bytes);
  kernels::multiplyPoints(x, rows.BT.data(), rows.n, rows.width, D_.data());
  kernels::gram(rows.G.data(), D_.data(), rows.s, rows.width, inverse_.data());
  kernels::invert(inverse_.data(), rows.s, rows.width, kPivotFloor, work_.data());
  valid_ = true;
  has_across_ = false;
  has_mobility_.assign(rows.n, 0);
}

void StickSolver::findAcross(const StickRows& rows) {
  if (!has_across_)
    kernels::spreadSticks(D_.data(), rows.spread_BW.data(), rows.s, rows.width, rows.coordinates,
                          across_.data());
  has_across_ = true;
}

double StickSolver::answer(const StickRows& rows, const int* particle, const double* force,
                           int count, double* out) {
  findAcross(rows);
  kernels::pullSticks(D_.data(), rows.WBT.data(), rows.width, particle, force, count,
                      lambda_.data());
  kernels::multiply(inverse_.data(), lambda_.data(), rows.s, rows.width, solved_.data());
  kernels::spreadPushes(rows.spread_W.data(), rows.coordinates, particle, force, count, out);
  double free = 0;
  for (int k = 0; k < count; ++k)
    for (int c = 0; c < 3; ++c) free += force[3 * k + c] * out[3 * particle[k] + c];
  kernels::addWeighted(out, across_.data(), solved_.data(), rows.s, rows.coordinates, out);
  return free;
}

const double* StickSolver::mobility(const StickRows& rows, const int* particle, int count) {
  for (int k = 0; k < count; ++k) {
    const int i = particle[k];
    if (has_mobility_[i]) continue;
    findAcross(rows);
    for (int stick = 0; stick < rows.s; ++stick)
      for (int c = 0; c < 3; ++c) pulls_(c, stick) = -(D_(c, stick) * rows.WBT(i, stick));
    kernels::multiplyPoints(pulls_.data(), inverse_.data(), rows.s, rows.width, rates_.data());
    mobility_.middleRows<3>(3 * i).setZero();
    for (int j = 0; j < 3 * rows.n; j += 3)
      for (int c = 0; c < 3; ++c) mobility_(3 * i + c, j + c) = rows.spread_W(i, j);
    kernels::addRows(rates_.data(), rows.s, rows.width, across_.data(), rows.coordinates,
                     mobility_.data() + 3 * i * rows.coordinates);
    has_mobility_[i] = 1;
  }
  return mobility_.data();
}

void StickSolver::move(const StickRows& rows, const double* lambda, double scale, double* x) {
  moved_.setZero();
  kernels::addImpulses(D_.data(), lambda, rows.s, rows.width, rows.BW.data(), rows.columns,
                       moved_.data());
  for (int j = 0; j < rows.n; ++j)
    for (int c = 0; c < 3; ++c) x[3 * j + c] += scale * moved_(c, j);
}

void StickSolver::projectVelocities(const StickRows& rows, double* v) {
  kernels::multiplyPoints(v, rows.BT.data(), rows.n, rows.width, rates_.data());
  lambda_.setZero();
  kernels::subtractDots(D_.data(), rates_.data(), rows.width, lambda_.data());
  solve(rows, lambda_.data());
  move(rows, lambda_.data(), 1, v);
}

}  // namespace ragdoll
