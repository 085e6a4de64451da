#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/joint_damping.h"
#include "ragdoll_sim/core/shake_step.h"

namespace ragdoll {
namespace {

constexpr double kReportedRise = 1e-6;  ///< [J] less is rounding

}  // namespace

double ShakeStep::kineticEnergy() {
  const Eigen::MatrixXd& M = model_.skeletonOf(ragdoll_).M;
  return 0.5 * (v() * M).cwiseProduct(v()).sum();
}

double ShakeStep::energyRise() {
  if (driven_ || scratch_.presses.empty()) return 0;
  const Eigen::MatrixXd& M = model_.skeletonOf(ragdoll_).M;
  const Points moved = x() - scratch_.saved_x;
  double rise = kineticEnergy() -
                0.5 * (scratch_.saved_v * M).cwiseProduct(scratch_.saved_v).sum() -
                model_.gravity.dot((moved * M).rowwise().sum());
  if (ws_.forced) rise -= ws_.force.middleCols(ragdoll_.first, n_).cwiseProduct(moved).sum();
  return rise - releasedEnergy();
}

double ShakeStep::releasedEnergy() {
  double released = 0;
  for (const LimitRow& limit : scratch_.limits) {
    if (limit.compliance == 0) continue;
    const double value = std::min(0.0, valueAt(model_, state_.x, limit));
    released += (limit.start * limit.start - value * value) / (2 * limit.compliance);
  }
  return released;
}

void ShakeStep::limitEnergy(double rise) {
  const double before = kineticEnergy();
  scratch_.saved_v = v();
  dampInnerMotion(model_.skeletonOf(ragdoll_).M, model_.systemOf(ragdoll_).pins, 0, x(), v());
  const double rigid = kineticEnergy();
  const double inner = before - rigid;
  if (inner > rise) {
    v() += std::sqrt(1 - rise / inner) * (scratch_.saved_v - v());
  } else if (ws_.obstacles.empty()) {
    // v() is the rigid motion now: there is nothing more to take.
  } else {
    v() *= rigid > 0 ? std::sqrt(std::max(0.0, (before - rise) / rigid)) : 0;
  }
  limited_ = limited_ || rise > kReportedRise;
}

}  // namespace ragdoll
