// Limits and contacts that are reached inside a step: located in time, so that the blow falls where
// it belongs and the order of the method survives it (docs/equations.md#contacts-and-limits).
#include <algorithm>
#include <cmath>

#include "core/direct/shake_step.h"

namespace ragdoll {
namespace {

constexpr int kMaxLocated = 8;    ///< in one step; later ones press over their whole substep
constexpr double kSlowSteps = 2;  ///< what comes slower than gravity in two steps is at rest
constexpr double kLeastPull = 1;  ///< [m/s^2] where gravity is less: other limbs pull, too
constexpr double kLever = 0.3;    ///< [m] on which gravity turns a limb
constexpr int kRefinements = 3;   ///< of the time at which rk arrives
constexpr double kSnap = 1e-6;    ///< of the substep: nearer to its ends is there

}  // namespace

double ShakeStep::timeOfZero(double start, double rate, double end, double h) {
  if (start <= 0) return 0;
  const double q = (end - start - rate * h) / (h * h);
  const double root = std::sqrt(std::max(0.0, rate * rate - 4 * q * start));
  return 2 * start / (root - rate);
}

double ShakeStep::rateOf(const Contact& c) const {
  return c.normal.dot(motionOf(c, state_.v.data() + 3 * ragdoll_.first) - c.surface_motion / step_);
}

double ShakeStep::rateOf(const LimitRow& limit) const {
  LimitRow row = limit;
  anglesBefore().evaluate(model_, state_.x, row);
  double rate = 0;
  for (int k = 0; k < row.count; ++k) rate += row.gradient[k].dot(state_.v.col(row.particle[k]));
  return rate;
}

bool ShakeStep::isArriving(const Contact& c, double h) const {
  if (c.gap_start < -contact_tolerance_) return false;
  const double end = gapAt(c, scratch_.dx.data());
  if (end < -kDeepImpact * rows_.scale) return located_ < kMaxImpacts;
  if (c.obstacle < 0 || located_ >= kMaxLocated) return false;
  const double rate = c.before < touching_ ? rateOf(c) : (end - c.before) / h;
  return -rate > kSlowSteps * step_ * std::max(kLeastPull, std::abs(c.normal.dot(model_.gravity)));
}

bool ShakeStep::isArriving(const LimitRow& limit, double h) const {
  if (limit.compliance > 0 || located_ >= kMaxLocated) return false;
  if (limit.before < -touching_angle_) return false;
  const double rate =
      limit.before < touching_angle_ ? rateOf(limit) : (limit.value - limit.before) / h;
  return -rate > kSlowSteps * step_ * std::max(kLeastPull, model_.gravity.norm()) / kLever;
}

void ShakeStep::findArrivals(double h) {
  if (overlap_ > kSqueezed) return;
  for (std::size_t i = 0; i < scratch_.contacts.size(); ++i)
    if (isArriving(scratch_.contacts[i], h)) scratch_.contact_role[i] = ShakeScratch::kArriving;
  for (std::size_t i = 0; i < scratch_.limits.size(); ++i)
    if (isArriving(scratch_.limits[i], h)) scratch_.limit_role[i] = ShakeScratch::kArriving;
}

bool ShakeStep::arrivesBefore() {
  for (std::size_t i = 0; i < scratch_.contacts.size(); ++i)
    if (scratch_.contact_role[i] == ShakeScratch::kArriving &&
        gapAt(scratch_.contacts[i], scratch_.dx.data()) < -contact_tolerance_)
      return true;
  const LimitAngles::Pose& angles = anglesAfter();
  for (std::size_t i = 0; i < scratch_.limits.size(); ++i)
    if (scratch_.limit_role[i] == ShakeScratch::kArriving && angles[scratch_.limits[i].limit] < 0)
      return true;
  return false;
}

double ShakeStep::firstArrival(double h) {
  const double* dx = scratch_.dx.data();
  double first = 2 * h;
  arrival_ = nullptr;
  const auto consider = [&](double t, std::uint8_t& role) {
    if (!(t < first)) return;
    first = std::clamp(t, 0.0, h);
    arrival_ = &role;
  };
  for (std::size_t i = 0; i < scratch_.contacts.size(); ++i) {
    const Contact& c = scratch_.contacts[i];
    if (scratch_.contact_role[i] != ShakeScratch::kArriving) continue;
    const double end = gapAt(c, dx);
    if (end < -contact_tolerance_)
      consider(timeOfZero(c.before, rateOf(c), end, h), scratch_.contact_role[i]);
  }
  const LimitAngles::Pose& angles = anglesAfter();
  for (std::size_t i = 0; i < scratch_.limits.size(); ++i) {
    if (scratch_.limit_role[i] != ShakeScratch::kArriving) continue;
    const LimitRow& limit = scratch_.limits[i];
    const double end = angles[limit.limit];
    if (end < 0) consider(timeOfZero(limit.before, rateOf(limit), end, h), scratch_.limit_role[i]);
  }
  if (!arrival_) return first;
  return first < kSnap * h ? 0 : first > (1 - kSnap) * h ? h : first;
}

void ShakeStep::takeArrival(bool mine) {
  if (mine) *arrival_ = ShakeScratch::kArrived;
  for (std::vector<std::uint8_t>* roles : {&scratch_.contact_role, &scratch_.limit_role})
    std::replace(roles->begin(), roles->end(), std::uint8_t{ShakeScratch::kArriving},
                 std::uint8_t{ShakeScratch::kIfNear});
  ++located_;
}

double ShakeStep::arriveSmoothly(double h) {
  findArrivals(h);
  for (std::size_t i = 0; i < scratch_.contacts.size(); ++i)
    if (scratch_.contact_role[i] != ShakeScratch::kArriving &&
        (scratch_.contacts[i].before <= touching_ ||
         gapAt(scratch_.contacts[i], scratch_.dx.data()) <= touching_))
      return 2 * h;
  for (std::size_t i = 0; i < scratch_.limits.size(); ++i)
    if (scratch_.limit_role[i] != ShakeScratch::kArriving &&
        (scratch_.limits[i].value <= 0 || scratch_.limits[i].start != 0))
      return 2 * h;
  double until = firstArrival(h);
  if (until > h) return until;
  takeArrival(true);
  for (int i = 0; i < kRefinements && until > 0; ++i) {
    smoothIncrement(until);
    if (failed_) return until;
    const double better = std::min(arrivalAgain(until), h);
    if (i + 1 == kRefinements || std::abs(better - until) < kSnap * h) break;
    until = better;
  }
  if (until > 0) moveSmoothly();
  bounce();
  return std::max(until, kSnap * h);
}

double ShakeStep::arrivalAgain(double h) {
  const double* dx = scratch_.dx.data();
  for (std::size_t i = 0; i < scratch_.contacts.size(); ++i)
    if (scratch_.contact_role[i] == ShakeScratch::kArrived) {
      const Contact& c = scratch_.contacts[i];
      return timeOfZero(c.before, rateOf(c), gapAt(c, dx), h);
    }
  for (std::size_t i = 0; i < scratch_.limits.size(); ++i)
    if (scratch_.limit_role[i] == ShakeScratch::kArrived) {
      const LimitRow& limit = scratch_.limits[i];
      return timeOfZero(limit.before, rateOf(limit), anglesAfter()[limit.limit], h);
    }
  return h;
}

}  // namespace ragdoll
