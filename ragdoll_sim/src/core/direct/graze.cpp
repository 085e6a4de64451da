#include "core/direct/graze.h"

#include <algorithm>
#include <cmath>

#include "core/direct/constants.h"
#include "core/direct/contact_motion.h"
#include "core/direct/contact_path.h"

namespace ragdoll {
namespace {

/// [rad] of a limit at both ends of a motion, and its rates there over the motion.
struct GapEnds {
  double start, end, start_rate, end_rate;

  /// Of the cubic [Hairer1993, II.6].
  double at(double share) const {
    const double left = 1 - share;
    return left * left * ((1 + 2 * share) * start + share * start_rate) +
           share * share * ((1 + 2 * left) * end - left * end_rate);
  }
};

/// Share of the motion at which a gap that shrinks at its start and grows in the end is smallest.
double lowest(const GapEnds& gap) {
  // The derivative a + 2 b s + c s^2 goes from below zero to above it.
  const double a = gap.start_rate, rise = gap.end - gap.start;
  const double b = 3 * rise - 2 * gap.start_rate - gap.end_rate;
  const double c = 3 * (gap.start_rate + gap.end_rate - 2 * rise);
  return -a / (b + std::sqrt(std::max(0.0, b * b - a * c)));
}

/// Has the share be that of this gap if it is touched earlier.
void consider(const GapEnds& gap, double touching, double& first) {
  if (!(gap.start > touching && gap.end > touching && gap.start_rate < 0 && gap.end_rate > 0))
    return;
  const double share = lowest(gap);
  if (share > kSnap && share < first && gap.at(share) <= touching) first = share;
}

/// [m/s] Of the body's own points.
using Velocities = Eigen::Ref<const Points>;

/// [rad] over h.
double openingOf(const Body& body, const LimitRow& limit, const Velocities& v, double h) {
  double rate = 0;
  for (int k = 0; k < limit.count; ++k)
    rate += limit.gradient[k].dot(v.col(limit.particle[k] - body.first));
  return h * rate;
}

}  // namespace

double timeOfGraze(const Body& body, const Points& v1, double h) {
  const ConstraintSet& set = body.constraints;
  const Tolerances& tolerances = body.context->tolerances;
  const Velocities v0 = body.v();
  double first = 1;
  for (const Contact& c : set.contacts) {
    const double end = gapAfter(body, c);
    if (std::min(c.gap_start, end) > tolerances.touching && c.gap_start + end < travelOf(body, c))
      first = std::min(first, shareOfGraze(pathOf(body, c, h, &v1), tolerances.touching));
  }
  for (const LimitRow& limit : set.limits) {
    const LimitRow before = anglesBefore(body).row(limit.limit, aheadOf(body));
    const LimitRow& after = anglesAfter(body).row(limit.limit, aheadOf(body));
    consider(
        {limit.before, limit.value, openingOf(body, before, v0, h), openingOf(body, after, v1, h)},
        tolerances.touching_angle, first);
  }
  return first * h;
}

}  // namespace ragdoll
