#include "core/direct/mode_event_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/contact/first_touch.h"
#include "core/direct/constants.h"
#include "core/direct/mode_constants.h"
#include "core/direct/mode_motion.h"
#include "core/direct/mode_piece.h"
#include "core/direct/mode_rows.h"

namespace ragdoll {
namespace {

/// What a row may do that ends a piece: each a function that is not negative until then.
enum Event { kGap, kForce, kFriction, kMotion, kPlace };
static_assert(kPlace + 1 == kEventsOfRow);

constexpr double kLasting = 1;  ///< of what does not end the mode

/// Where the functions are not negative as long as the mode lasts, at a point whose forces are
/// known.
double eventValue(Island& island, std::size_t i, Event event, const ModePoint& point) {
  const ModeRow& row = island.s.mode.rows[i];
  const double none = 2 * kNoForce * island.s.mode.force_scale;
  if (event == kGap) {
    if (row.presses) return kLasting;
    const double noise = row.gap_start < kClosedGap ? kGapNoise : 0;
    const double opening = openingOf(island, row, point.x.data(), point.v.data()) -
                           std::min(0.0, row.gap_start) + noise;
    return opening > 0 || !isEndOfTouchingStick(island, row, point.x.data()) ? opening : kLasting;
  }
  if (!row.presses) return kLasting;
  if (event == kForce) return point.forces.normal[i] + none;
  if (event == kPlace)
    return std::min(kLasting, roomOf(island, row, point.x.data(), row.feature) + kPlaceNoise);
  if (!(row.friction > 0) || (event == kMotion && !row.impending)) return kLasting;
  const auto slip = [&] {
    const double *x = point.x.data(), *v = point.v.data();
    return slipOf(island, row, placeOf(island, row, x, v, false), x, v).dot(row.slip);
  };
  if (event == kMotion) return kImpendingStill - slip();
  if (row.sticks)
    return row.friction * point.forces.normal[i] - point.forces.friction[i].norm() + none;
  if (row.impending) {
    const Vec3& f = point.forces.friction[i];
    const double across = (f - f.dot(row.slip) * row.slip).norm();
    return kMostLean * row.friction * point.forces.normal[i] - across + none;
  }
  return slip() + kSlipNoise;
}

/// Functions at a point, whose accelerations are found if something presses.
bool eventsAt(Island& island, ModePoint& point, std::vector<double>& values) {
  Mode& mode = island.s.mode;
  if (!accelerateInMode(island, point)) return false;
  values.resize(kEventsOfRow * mode.rows.size());
  for (std::size_t i = 0; i < mode.rows.size(); ++i)
    for (int e = 0; e < kEventsOfRow; ++e)
      values[kEventsOfRow * i + e] = eventValue(island, i, static_cast<Event>(e), point);
  // Beyond its place, by however little, a row's forces are of another surface, or of one that is
  // not there, and so are all that answer to them: it has left that first.
  bool any_left = false;
  for (std::size_t i = 0; i < mode.rows.size(); ++i)
    any_left = any_left || values[kEventsOfRow * i + kPlace] < kPlaceNoise;
  for (std::size_t i = 0; any_left && i < mode.rows.size(); ++i)
    for (const Event event : {kForce, kFriction, kMotion})
      values[kEventsOfRow * i + event] = kLasting;
  return true;
}

/// Of one of the functions at a share of the motion from mode.start to mode.end.
bool valueAt(Island& island, double h, double share, std::size_t which, double& value) {
  Mode& mode = island.s.mode;
  const Event event = static_cast<Event>(which % kEventsOfRow);
  interpolate(mode.start, mode.end, h, share, mode.sample);
  if (event != kGap && !accelerateInMode(island, mode.sample)) return false;
  value = eventValue(island, which / kEventsOfRow, event, mode.sample);
  return true;
}

/// Zero between two shares by false position (Illinois [Dowell1971]).
bool findZero(Island& island, double h, std::size_t which, double lo, double open, double hi,
              double closed, double& share) {
  int last = 0;
  share = hi;
  if (!(open > 0)) {
    share = lo;
    return true;
  }
  for (int k = 0; k < kZeroSearches && hi - lo > kZeroShare; ++k) {
    share = lo + (hi - lo) * open / (open - closed);
    double now = 0;
    if (!valueAt(island, h, share, which, now)) return false;
    if (now == 0) return true;
    const int side = now > 0 ? 1 : -1;
    (side > 0 ? lo : hi) = share;
    (side > 0 ? open : closed) = now;
    if (side == last) (side > 0 ? closed : open) *= 0.5;
    last = side;
  }
  return true;
}

/// The first event between two shares, of those that are negative at the later one: mode.earlier
/// and mode.event are the functions there.
bool findFirst(Island& island, double h, double before, double share, ModeEvent& found) {
  Mode& mode = island.s.mode;
  double last = share;
  for (int tries = 0; tries < kEventRefinements; ++tries) {
    double first = share;
    std::size_t which = mode.event.size();
    for (std::size_t j = 0; j < mode.event.size(); ++j) {
      if (mode.event[j] >= 0) continue;
      const double open = std::max(0.0, mode.earlier[j]);
      const double about = before + (last - before) * open / (open - mode.event[j]);
      if (which < mode.event.size() && about >= first) continue;
      first = about;
      which = j;
    }
    if (which == mode.event.size() || (found.any && which == found.which)) return true;
    double at = last;
    if (!findZero(island, h, which, before, mode.earlier[which], last, mode.event[which], at))
      return false;
    found = {true, which, at};
    if (at <= before) return true;
    interpolate(mode.start, mode.end, h, at, mode.sample);
    if (!eventsAt(island, mode.sample, mode.event)) return false;
    mode.event[which] = std::max(0.0, mode.event[which]);
    last = at;
  }
  return true;
}

/// [m/s] Of the fastest point at either end of the motion, and twice that: two sides may come to
/// each other so fast.
double fastestApproach(const Mode& mode) {
  double square = 0;
  for (const ModePoint* point : {&mode.start, &mode.end})
    for (Eigen::Index i = 0; i + 2 < point->v.size(); i += 3)
      square = std::max(square, point->v.segment<3>(i).squaredNorm());
  return 2 * std::sqrt(square);
}

/// The share between two at which a row that is open at both, mode.earlier and mode.event, is
/// nearest, if it is closed there: it would be left again unseen. kNeverTouched: there is none.
double shareOfGraze(Island& island, double h, double before, double share) {
  Mode& mode = island.s.mode;
  const double reach = (share - before) * h * fastestApproach(mode);
  double first = kNeverTouched;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const std::size_t which = kEventsOfRow * i + kGap;
    const double start = mode.earlier[which], end = mode.event[which];
    const double lever = mode.rows[i].isContact() ? 1 : kLever;
    if (mode.rows[i].presses || !(start > 0 && end > 0) || lever * (start + end) >= reach) continue;
    const auto gap = [&](double at) {
      interpolate(mode.start, mode.end, h, at, mode.stage);
      return eventValue(island, i, kGap, mode.stage) + kGapNoise;
    };
    first = std::min(first, lowestIfClosed(gap, before, start, share, end));
  }
  return first;
}

/// Whether something rigid has closed before mode.end: the search for one event may lead past
/// another.
bool passedAnother(Island& island) {
  const Mode& mode = island.s.mode;
  for (std::size_t i = 0; i < mode.rows.size(); ++i)
    if (!mode.rows[i].isSoft() && eventValue(island, i, kGap, mode.end) < -kClosedGap) return true;
  return false;
}

}  // namespace

bool findModeEvent(Island& island, double h, ModeEvent& found) {
  Mode& mode = island.s.mode;
  found = {};
  if (!eventsAt(island, mode.start, mode.earlier)) return false;
  if (!accelerateInMode(island, mode.end)) return false;  // the polynomial takes them
  double before = 0;
  mode.sample = mode.end;
  for (int k = 1; k <= kEventSamples && !found.any; ++k) {
    double share = k / static_cast<double>(kEventSamples);
    ModePoint& point = k < kEventSamples ? mode.sample : mode.end;
    if (k < kEventSamples) interpolate(mode.start, mode.end, h, share, point);
    if (!eventsAt(island, point, mode.event)) return false;
    const double graze = shareOfGraze(island, h, before, share);
    if (graze < share) {
      share = graze;
      interpolate(mode.start, mode.end, h, share, mode.sample);
      if (!eventsAt(island, mode.sample, mode.event)) return false;
    }
    if (!findFirst(island, h, before, share, found)) return false;
    std::swap(mode.event, mode.earlier);
    before = share;
  }
  return true;
}

bool moveToModeEvent(Island& island, double h, const ModeEvent& found, double& time) {
  Mode& mode = island.s.mode;
  const Event event = static_cast<Event>(found.which % kEventsOfRow);
  const double lo = std::max(0.0, found.share - kSlopeShare);
  const double hi = std::min(1.0, lo + 2 * kSlopeShare);
  double first = 0, second = 0;
  if (!valueAt(island, h, lo, found.which, first) || !valueAt(island, h, hi, found.which, second))
    return false;
  double slope = (second - first) / ((hi - lo) * h);
  double earlier = 0, value_earlier = 0;
  time = found.share * h;
  for (int k = 0; k < kEventRefinements; ++k) {
    if (!moveInMode(island, time, mode.end, mode.piece) || !accelerateInMode(island, mode.end))
      return false;
    const double value = eventValue(island, found.which / kEventsOfRow, event, mode.end);
    if (k > 0 && value != value_earlier && time != earlier)
      slope = (value - value_earlier) / (time - earlier);
    earlier = time;
    value_earlier = value;
    const double change = slope < 0 ? -value / slope : 0;
    // Not zero, and not on the way there: a motion beyond what the piece can follow told of it.
    if (!(slope < 0) && value > 0 && !(h < kEventNear)) return false;
    const bool settled = std::abs(change) < kEventTime || !(slope < 0);
    const bool last = k + 1 == kEventRefinements;
    if (settled || (last && std::abs(change) < kEventNear)) return !passedAnother(island);
    if (last) return false;
    time = std::clamp(time + std::clamp(change, -kMostCorrection * h, kMostCorrection * h), 0.0, h);
    if (time == earlier) return !passedAnother(island);
  }
  return false;
}

}  // namespace ragdoll
