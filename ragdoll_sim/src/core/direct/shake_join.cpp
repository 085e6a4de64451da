// Sticks that are far from their lengths: particles placed apart, or held too far apart by pins.
#include <algorithm>
#include <cmath>

#include "core/direct/shake_step.h"

namespace ragdoll {
namespace {

constexpr double kWhole = 1e-6;      ///< relative error of a squared length: below, nothing to join
constexpr double kJoinTime = 0.05;   ///< [s] in which a gap shrinks to 1 / e
constexpr double kNoLength = 1e-3;   ///< of a stick's length: below, it has no direction
constexpr double kSpread = 0.02;     ///< of the rest pose: what gives it one
constexpr double kRounding = 4e-15;  ///< of positions, relative, with some room
constexpr int kSweeps = 60;          ///< of relaxation, where Newton's method fails

}  // namespace

void ShakeStep::join(double h) {
  length2_ = rows_.length2.data();
  inverse_length2_ = rows_.inverse_length2.data();
  if (rows_.s == 0) return;
  tolerance_ = std::max(kTolerance, kRounding * x().cwiseAbs().maxCoeff() /
                                        std::sqrt(rows_.length2.head(rows_.s).minCoeff()));
  if (stickError() < std::max(kWhole, 10 * tolerance_)) return;
  ++report_.joining;
  spreadCollapsed();
  body_.start.setPose(rows_, xData());
  const double keep = std::exp(-h / kJoinTime);
  scratch_.lengths2 = rows_.length2;
  for (int s = 0; s < rows_.s; ++s) {
    const double length = std::sqrt(rows_.length2[s]), now = std::sqrt(lengthNow2(s));
    scratch_.lengths2[s] = std::pow(length + keep * (now - length), 2);
  }
  length2_ = scratch_.lengths2.data();
  scratch_.dx.setZero(3, n_);
  scratch_.lambda.setZero(rows_.width);
  const Points before = x();
  if (relaxAlongNew()) {
    x() += scratch_.dx;
  } else {
    relaxInTurn();
    if (!x().allFinite()) x() = before;
  }
  body_.start.setPose(rows_, xData());
  for (int s = 0; s < rows_.s; ++s) scratch_.lengths2[s] = lengthNow2(s);
  scratch_.inverse_lengths2 = rows_.inverse_length2;
  scratch_.inverse_lengths2.head(rows_.s) = scratch_.lengths2.head(rows_.s).cwiseInverse();
  inverse_length2_ = scratch_.inverse_lengths2.data();
  body_.start.projectVelocities(rows_, vData());
}

double ShakeStep::lengthNow2(int stick) const {
  return Eigen::Map<const PaddedRows>(body_.start.D(), 3, rows_.width).col(stick).squaredNorm();
}

double ShakeStep::stickError() {
  body_.start.setPose(rows_, xData());
  double worst = 0;
  for (int s = 0; s < rows_.s; ++s)
    worst = std::max(worst, std::abs(lengthNow2(s) / rows_.length2[s] - 1));
  return worst;
}

void ShakeStep::spreadCollapsed() {
  bool collapsed = false;
  for (int s = 0; s < rows_.s; ++s)
    collapsed = collapsed || lengthNow2(s) < kNoLength * kNoLength * rows_.length2[s];
  if (!collapsed) return;
  const Points& rest = model_.skeletonOf(ragdoll_).rest;
  const Vec3 middle = rest.rowwise().mean();
  for (int i = 0; i < n_; ++i)
    if (system_.W(i, i) > 0) x().col(i) += kSpread * (rest.col(i) - middle);
}

void ShakeStep::relaxInTurn() {
  Points moved = x();
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int s = 0; s < rows_.s; ++s) {
      const Vec3 d = moved * system_.B.row(s).transpose();
      const double now = std::max(d.norm(), kMinLength);
      if (!(system_.G(s, s) > 0)) continue;
      moved += (std::sqrt(length2_[s]) / now - 1) / system_.G(s, s) * d * system_.BW.row(s);
    }
  x() = moved;
}

}  // namespace ragdoll
