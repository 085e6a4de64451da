#include "core/direct/penetration.h"

#include <algorithm>
#include <cmath>

#include "core/direct/constants.h"

namespace ragdoll {

double allowedPenetration(const Contact& pair, double over, double step) {
  const double overlap = std::max(0.0, -pair.gap_start), more = overlap - kSlop;
  const double behind = std::max(0.0, -pair.before) * (1 - over / step);
  return std::max(behind, more > 0 ? kSlop + more * std::exp(-over / kRecoveryTime) : overlap);
}

double gapBefore(const Contact& c, double plane) {
  return c.touches_at_start ? c.gap_start : plane;
}

double recoverySpeed(const Contact& c) {
  return c.follows ? kFollowedRecoverySpeed : kRecoverySpeed;
}

double movedOffset(const Contact& c, const MotionSpan& span) {
  return c.found - (span.substep - span.over) / span.step * c.normal.dot(c.surface_motion);
}

double allowedOffset(const Contact& c, const MotionSpan& span) {
  if (c.isSoft()) return movedOffset(c, span);
  if (c.count == 4) return c.found - allowedPenetration(c, span.over, span.step);
  // In a part of a step a part of it, or what rounding leaves would become a speed.
  const double least = std::max(0.0, -c.before) * (1 - span.over / span.step);
  const double stays = c.gap_start < 0 ? -c.gap_start - recoverySpeed(c) * span.over : 0;
  return movedOffset(c, span) - std::max({0.0, least, stays});
}

double allowedViolation(const LimitRow& limit, const MotionSpan& span, OverlapPolicy policy) {
  const double least = std::max(0.0, -limit.before) * (1 - span.over / span.step);
  const double turn = policy == OverlapPolicy::kResolve ? kRecoveryTurn * span.over : 0;
  const double stays = limit.value < -kClose / kLever ? -limit.before - turn : 0;
  return std::max({0.0, least, stays});
}

bool isIgnored(const Contact& c, OverlapPolicy policy) {
  if (policy == OverlapPolicy::kResolve) return false;
  return c.gap_start <= (policy == OverlapPolicy::kIgnoreDeep ? -kClose : kTouching);
}

}  // namespace ragdoll
