#include <algorithm>
#include <cmath>

#include "core/direct/shake_step.h"
#include "core/mechanics/energy_gain.h"
#include "core/mechanics/joint_damping.h"

namespace ragdoll {
namespace {

constexpr double kReportedRise = 1e-6;  ///< [J] less is rounding
constexpr double kWildSpeed = 10;       ///< [m/s]

}  // namespace

double ShakeStep::kineticEnergy() { return ragdoll::kineticEnergy(rows_, v(), scratch_.energy); }

double ShakeStep::driveSpeed() const {
  if (!driven_) return 0;
  double speed = pin_speed_;
  for (const Contact& c : scratch_.contacts)
    speed = std::max(speed, c.surface_motion.norm() / step_);
  return speed;
}

bool ShakeStep::isSmooth() const {
  const auto held = [this](const LimitRow& limit) {
    return limit.compliance == 0 && std::abs(limit.before) < touching_angle_;
  };
  const auto holds = [this](const Press& press) {
    return std::any_of(scratch_.touching_limits.begin(), scratch_.touching_limits.end(),
                       [&press](const LimitRow& limit) { return press.a == -1 - limit.limit; });
  };
  return located_ == located_before_ && scratch_.touching.empty() &&
         std::all_of(scratch_.touching_limits.begin(), scratch_.touching_limits.end(), held) &&
         std::all_of(scratch_.presses.begin(), scratch_.presses.end(), holds);
}

double ShakeStep::energyRise(bool smooth) {
  return pin_speed_ == 0 ? gainedEnergy(smooth ? 0 : driveSpeed()) : 0;
}

double ShakeStep::swingScale() {
  return kineticEnergy() + rows_.mass.sum() * model_.gravity.norm() * rows_.scale;
}

double ShakeStep::wildRise() {
  return ragdoll::kineticEnergy(rows_, scratch_.saved_v, scratch_.energy) +
         0.5 * rows_.mass.sum() * kWildSpeed * kWildSpeed;
}

bool ShakeStep::isLargeSwing(double change) {
  return change != 0 && std::abs(change) > kRedoSwing * swingScale();
}

double ShakeStep::gainedEnergy(double drive) {
  Points& moved = scratch_.stay;
  moved = x() - scratch_.saved_x;
  double rise = energyGain(rows_, scratch_.saved_v, v(), moved, model_.gravity, scratch_.energy);
  if (ws_.forced) rise -= ws_.force.middleCols(ragdoll_.first, n_).cwiseProduct(moved).sum();
  rise -= releasedEnergy();
  if (drive > 0) {
    // Seen from what drives it the body gains nothing; here it may be faster by twice its speed.
    const double mass = rows_.mass.sum();
    const double before = ragdoll::kineticEnergy(rows_, scratch_.saved_v, scratch_.energy);
    rise -= 2 * mass * drive * (std::sqrt(2 * before / mass) + drive);
  }
  return rise;
}

double ShakeStep::releasedEnergy() {
  double released = 0;
  for (const LimitRow& limit : scratch_.limits) {
    if (limit.compliance == 0) continue;
    const double value = std::min(0.0, anglesBefore()[limit.limit]);
    released += (limit.start * limit.start - value * value) / (2 * limit.compliance);
  }
  return released;
}

bool ShakeStep::limitEnergy(double rise) {
  const double before = kineticEnergy();
  const Points all = v();
  const std::vector<int>& pins = model_.systemOf(ragdoll_).pins;
  dampInnerMotion(model_.skeletonOf(ragdoll_).M, pins, 0, x(), v());
  const double rigid = kineticEnergy();
  const double inner = before - rigid;
  const bool held = !pins.empty() ||
                    std::any_of(scratch_.presses.begin(), scratch_.presses.end(),
                                [](const Press& press) { return press.obstacle >= 0; }) ||
                    std::any_of(scratch_.touching.begin(), scratch_.touching.end(),
                                [](const Contact& contact) { return contact.obstacle >= 0; });
  if (inner > rise) {
    v() += std::sqrt(1 - rise / inner) * (all - v());
  } else if (held) {
    v() *= rigid > 0 ? std::sqrt(std::max(0.0, (before - rise) / rigid)) : 0;
  }  // else v() is the rigid motion now, whose momentum is nobody's to take
  limited_ = limited_ || rise > kReportedRise;
  return inner > rise || held || rise - inner <= kRedoRise * before;
}

}  // namespace ragdoll
