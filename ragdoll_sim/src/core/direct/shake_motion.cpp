#include <algorithm>

#include "core/direct/shake_step.h"

namespace ragdoll {
namespace {

constexpr int kMaxNewton = 25;  ///< iterations; 2 to 4 are usual

}  // namespace

double ShakeStep::advance(double h) {
  body_.start.setPose(rows_, xData());
  freeMotion(h);
  findConstraints(h);
  findArrivals(h);
  press(h);
  const double until = failed_ ? 2 * h : firstArrival(h);
  if (until > h) {
    finish(h);
    return h;
  }
  takeArrival(true);
  if (until > 0) {
    shorten(until, h);
    freeMotion(until);
    press(until);
    finish(until, true, true);
  } else {
    bounce();
  }
  return std::max(until, 1e-6 * h);
}

double ShakeStep::advanceSmooth(double h) {
  if (!smoothMotion(h)) {
    const double until = failed_ ? 2 * h : arriveSmoothly(h);
    return until <= h ? until : advance(h);
  }
  moveSmoothly();
  return h;
}

void ShakeStep::smoothIncrement(double h) {
  double* m = multipliers();
  rungeKutta(rows_, body_.start, body_.end, xData(), vData(), scratch_.acceleration, h,
             scratch_.stages, scratch_.dx, scratch_.v1, m);
  for (int s = 0; s < rows_.s; ++s) m[s] = m[s + rows_.s] = 0.5 * m[s];  // per h^2 of x, not of v
  scratch_.lambda.setZero(rows_.width);
  if (!satisfySticks()) failed_ = true;
}

bool ShakeStep::smoothMotion(double h) {
  smoothIncrement(h);
  findConstraints(h);
  for (const Contact& c : scratch_.contacts)
    if (gapAt(c, scratch_.dx.data()) <= touching_ || c.gap_start <= touching_) return false;
  for (const LimitRow& l : scratch_.limits)
    if (l.value <= 0 || l.start != 0) return false;
  return true;
}

void ShakeStep::moveSmoothly() {
  scratch_.presses.clear();
  x() += scratch_.dx;
  v() = scratch_.v1;
  body_.end.setPose(rows_, xData());
  body_.end.projectVelocities(rows_, vData());
  std::swap(body_.start, body_.end);
}

void ShakeStep::freeMotion(double h) {
  scratch_.dx = h * v() + (0.5 * h * h) * scratch_.acceleration;
  scratch_.lambda.setZero(rows_.width);
  double* warm = multipliers();     // per h^2: of the last motion,
  double* before = warm + rows_.s;  // and of the one before it; extrapolated to this one
  for (int s = 0; s < rows_.s; ++s) scratch_.lambda[s] = (2 * warm[s] - before[s]) * h * h;
  body_.start.move(rows_, scratch_.lambda.data(), 1, scratch_.dx.data());
  if (!satisfySticks()) failed_ = true;
  for (int s = 0; s < rows_.s; ++s) {
    before[s] = warm[s];
    warm[s] = scratch_.lambda[s] / (h * h);
  }
}

bool ShakeStep::satisfySticks() {
  PaddedRows& D1 = scratch_.D1;
  D1.resize(3, rows_.width);
  kernels::multiplyPoints(scratch_.dx.data(), rows_.BT.data(), n_, rows_.width, D1.data());
  D1 += Eigen::Map<const PaddedRows>(body_.start.D(), 3, rows_.width);
  scratch_.residual.setZero(rows_.width);
  scratch_.correction.setZero(rows_.width);
  for (int iteration = 0; iteration < kMaxNewton; ++iteration) {
    const double worst = kernels::lengthResiduals(D1.data(), length2_, inverse_length2_,
                                                  rows_.width, scratch_.residual.data());
    if (worst < kTolerance) {
      if (iteration == 0) return true;
      scratch_.lambda += scratch_.correction;
      body_.start.move(rows_, scratch_.correction.data(), 1, scratch_.dx.data());
      return true;
    }
    if (!(worst < 1e6)) return false;
    body_.start.solve(rows_, scratch_.residual.data());
    scratch_.correction += scratch_.residual;
    body_.start.moveSticks(rows_, scratch_.residual.data(), D1.data());
  }
  return false;
}

}  // namespace ragdoll
