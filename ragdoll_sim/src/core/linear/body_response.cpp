#include "core/linear/body_response.h"

#include <algorithm>
#include <cmath>

#include "core/linear/constants.h"

namespace ragdoll {
namespace {

constexpr int kMaxNewton = 25;     ///< iterations; 2 to 4 are usual
constexpr double kDiverged = 1e6;  ///< relative error of a squared length: no way back from there

}  // namespace

void BodyResponse::bind(const DirectSystem& system) {
  if (system_ != &system)
    for (StickSolver* sticks : {&start_, &end_}) sticks->forget();  // of other masses or pins
  system_ = &system;
  rows_ = system.rows.get();
  start_.resize(*rows_);
  end_.resize(*rows_);
  for (PaddedRows* values : {&D1_, &pulls_, &rates_}) values->resize(3, rows_->width);
  for (Eigen::VectorXd* values : {&residual_, &correction_, &lambda_}) values->resize(rows_->width);
  for (Points* values : {&pose_, &free_}) values->resize(3, rows_->n);
}

double BodyResponse::startLength2(int stick) const {
  return Eigen::Map<const PaddedRows>(start_.D(), 3, rows_->width).col(stick).squaredNorm();
}

double BodyResponse::startError(const StickLengths& lengths) {
  return 2 * kernels::lengthResiduals(start_.D(), lengths.length2, lengths.inverse_length2,
                                      rows_->width, residual_.data());
}

void BodyResponse::setSticksAfter(const Points& dx) {
  kernels::multiplyPoints(dx.data(), rows_->BT.data(), rows_->n, rows_->width, D1_.data());
  D1_ += Eigen::Map<const PaddedRows>(start_.D(), 3, rows_->width);
  residual_.setZero(rows_->width);
}

double BodyResponse::findResiduals(const StickLengths& lengths) {
  return kernels::lengthResiduals(D1_.data(), lengths.length2, lengths.inverse_length2,
                                  rows_->width, residual_.data());
}

bool BodyResponse::alongStart(const StickLengths& lengths, Points& dx, Eigen::VectorXd& lambda) {
  const StickRows& rows = *rows_;
  setSticksAfter(dx);
  correction_.setZero(rows.width);
  for (int iteration = 0; iteration < kMaxNewton; ++iteration) {
    const double worst = findResiduals(lengths);
    if (worst < kLengthTolerance) {
      if (iteration == 0) return true;
      lambda += correction_;
      start_.move(rows, correction_.data(), 1, dx.data());
      return true;
    }
    if (!(worst < kDiverged)) return false;
    start_.solve(rows, residual_.data());
    correction_ += residual_;
    start_.moveSticks(rows, residual_.data(), D1_.data());
  }
  return false;
}

void BodyResponse::polishAlongStart(const StickLengths& lengths, Points& dx) {
  setSticksAfter(dx);
  findResiduals(lengths);
  start_.solve(*rows_, residual_.data());
  start_.move(*rows_, residual_.data(), 1, dx.data());
}

void BodyResponse::setFree(const Points& free) {
  free_ = free;
  kernels::multiplyPoints(free_.data(), rows_->BT.data(), rows_->n, rows_->width, pulls_.data());
}

const Eigen::VectorXd& BodyResponse::accelerate(bool at_end, const double* v, double* out) {
  const StickRows& rows = *rows_;
  StickSolver& sticks = at_end ? end_ : start_;
  kernels::multiplyPoints(v, rows.BT.data(), rows.n, rows.width, rates_.data());
  // d . d'' + d' . d' = 0 of every stick.
  lambda_.setZero(rows.width);
  kernels::subtractDots(sticks.D(), pulls_.data(), rows.width, lambda_.data());
  kernels::subtractDots(rates_.data(), rates_.data(), rows.width, lambda_.data());
  sticks.solve(rows, lambda_.data());
  std::copy(free_.data(), free_.data() + free_.size(), out);
  sticks.move(rows, lambda_.data(), 1, out);
  return lambda_;
}

void BodyResponse::relaxInTurn(const StickLengths& lengths, int sweeps, Points& x) const {
  const DirectSystem& system = *system_;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (int s = 0; s < rows_->s; ++s) {
      const Vec3 d = x * system.B.row(s).transpose();
      const double now = std::max(d.norm(), kMinLength);
      if (!(system.G(s, s) > 0)) continue;
      x += (std::sqrt(lengths.length2[s]) / now - 1) / system.G(s, s) * d * system.BW.row(s);
    }
}

double BodyResponse::endResiduals(const StickLengths& lengths) {
  const Eigen::Map<const PaddedRows> D(end_.D(), 3, rows_->width);
  double worst = 0;
  residual_.setZero(rows_->width);
  for (int s = 0; s < rows_->s; ++s) {
    // (L / |d| - 1) |d|^2: the length itself, not its square, so that far sticks come in evenly.
    const double q = std::max(D.col(s).squaredNorm(), kMinLength * kMinLength);
    residual_[s] = std::sqrt(lengths.length2[s] * q) - q;
    worst = std::max(worst, std::abs(lengths.length2[s] - q) / lengths.length2[s]);
  }
  return worst;
}

}  // namespace ragdoll
