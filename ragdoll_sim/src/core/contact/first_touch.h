// When a gap that closes during a step is first zero, for contacts whose plane is tangent there.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/contact/constants.h"
#include "core/contact/golden_section.h"

namespace ragdoll {

/// Time in [lo, hi] at which gap(time), `open` > 0 at lo and `closed` <= 0 at hi, is zero: regula
/// falsi that halves the value at an end that stays (Illinois [Dowell1971]). Gaps to convex
/// obstacles are convex along a straight path, so that there is one such time.
template <class Gap>
double firstTouch(const Gap& gap, double lo, double open, double hi, double closed) {
  constexpr int kMaxEvaluations = 30;  // 5 to 8 are usual
  constexpr double kSettled = 1e-12;   // of the step
  constexpr double kRounding = 1e-14;  // [m]
  int stays = 0;                       // 1: the end at lo stayed last time, -1: the one at hi
  for (int i = 0; i < kMaxEvaluations && hi - lo > kSettled; ++i) {
    const double time = lo + (hi - lo) * open / (open - closed);
    const double now = gap(time);
    if (std::abs(now) < kRounding) return time;
    if (now > 0) {
      lo = time;
      open = now;
      if (stays == -1) closed *= 0.5;
      stays = -1;
    } else {
      hi = time;
      closed = now;
      if (stays == 1) open *= 0.5;
      stays = 1;
    }
  }
  return lo;
}

/// Conservative advancement [Mirtich1996]: moves `time` on, towards 1, while gap(time), which is
/// `now` and shrinks by at most `travel` [m] in all, is open.
template <class Gap>
void advance(const Gap& gap, double travel, double& time, double& now) {
  constexpr int kMaxAdvances = 64;  // grazing paths converge slowly
  for (int i = 0; i < kMaxAdvances && now > kGapResolution && time < 1; ++i) {
    time = std::min(1.0, time + now / travel);
    now = gap(time);
  }
}

/// Where a sweep that may pass through what is `thin` [m], and has stopped at `time` with a gap
/// `now` > 0, is first in touch; else where it ends, if the rest of its way is too short for that.
template <class Gap>
double touchAfter(const Gap& gap, double travel, double thin, double time, double now, double end) {
  if (end <= 0) return firstTouch(gap, time, now, 1, end);
  return (1 - time) * travel <= 0.5 * thin ? 1 : time;
}

constexpr double kNeverTouched = 2;

/// Time in [lo, hi] at which a gap that is open at both, `start` and `end`, is least, if it is
/// closed there; kNeverTouched: it stays open.
template <class Gap>
double lowestIfClosed(const Gap& gap, double lo, double start, double hi, double end) {
  const double near = (hi - lo) / 64;  // in which it is all but straight
  const double falls = (gap(lo + near) - start) / near;
  if (!(falls < 0)) return kNeverTouched;
  const double rises = (end - gap(hi - near)) / near;
  if (!(rises > 0)) return kNeverTouched;
  // Convex, it is above the lines through both its ends.
  const double cross = (start - end + rises * (hi - lo)) / (rises - falls);
  if (start + falls * std::clamp(cross, 0.0, hi - lo) > 0) return kNeverTouched;
  const double least = goldenSection(gap, lo, hi);
  return gap(least) > 0 ? kNeverTouched : least;
}

/// [m] A gap that is open by less slides or rests: it does not come to touch.
constexpr double kResting = 1e-6;

/// Whether what has that gap [m] slides or rests: it overlaps by no more than sound steps leave.
inline bool isResting(double gap) { return gap <= kResting && gap >= -kGapResolution; }

}  // namespace ragdoll
