#include "core/direct/mode_event_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/contact/first_touch.h"
#include "core/direct/constants.h"
#include "core/direct/mode_constants.h"
#include "core/direct/mode_motion.h"
#include "core/direct/mode_obstacles.h"
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
    const double opening = openingOf(island, row, point.x.data(), point.v.data()) -
                           std::min(0.0, row.gap_start) + row.gap_noise;
    return opening > 0 || !isEndOfTouchingStick(island, row, point.x.data()) ? opening : kLasting;
  }
  if (event == kForce)
    return row.presses ? point.forces.normal[i] + none
                       : std::min(kLasting, none - point.forces.idle[i]);
  if (!row.presses) return kLasting;
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
  // not there, and so are all that answer to them: it has left that first. What lies flat over an
  // edge is at the end of its place but for rounding.
  bool any_left = false;
  for (std::size_t i = 0; i < mode.rows.size(); ++i)
    any_left = any_left || values[kEventsOfRow * i + kPlace] < 0.5 * kPlaceNoise;
  for (std::size_t i = 0; any_left && i < mode.rows.size(); ++i)
    for (const Event event : {kForce, kFriction, kMotion})
      values[kEventsOfRow * i + event] = kLasting;
  return true;
}

/// What has opened was not closed but for rounding: it closes at zero. value: of its gap.
void forgetNoise(ModeRow& row, double& value) {
  if (row.presses || value == kLasting || !(value > kOpened)) return;
  value -= row.gap_noise;
  row.gap_noise = 0;
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

/// Where the zero of a function may be that is positive before it, by its values one after the
/// other: by their slope, and between one on either side of it by false position (Illinois
/// [Dowell1971]).
class ZeroSearch {
 public:
  /// h: it is before that; slope: of the function, about.
  ZeroSearch(double h, double slope) : h_(h), hi_(h), slope_(slope) {}

  double width() const { return hi_ - lo_; }  ///< within which it is

  /// Where to look after `value` at `time`; NaN: it does not go towards zero.
  double after(double time, double value) {
    if (known_ && value != value_ && time != time_) slope_ = (value - value_) / (time - time_);
    known_ = true;
    time_ = time;
    value_ = value;
    const int side = value > 0 ? 1 : -1;
    (side > 0 ? lo_ : hi_) = time;
    (side > 0 ? open_ : closed_) = value;
    if (side == side_) (side > 0 ? closed_ : open_) *= 0.5;
    side_ = side;
    if (open_ > 0 && closed_ < 0) return lo_ + (hi_ - lo_) * open_ / (open_ - closed_);
    if (slope_ < 0) {
      const double most = kMostCorrection * h_;
      return std::clamp(time + std::clamp(-value / slope_, -most, most), 0.0, h_);
    }
    return value > 0 ? std::numeric_limits<double>::quiet_NaN() : 0.5 * time;
  }

 private:
  double h_, lo_ = 0, hi_, slope_, open_ = 0, closed_ = 0;  // 0: not known
  bool known_ = false;
  double time_ = 0, value_ = 0;
  int side_ = 0;
};

/// Zero between two shares.
bool findZero(Island& island, double h, std::size_t which, double lo, double open, double hi,
              double closed, double& share) {
  share = lo;
  if (!(open > 0)) return true;
  ZeroSearch zero(1, 0);
  zero.after(lo, open);
  double next = zero.after(hi, closed), now = closed;
  share = hi;
  for (int k = 0; k < kZeroSearches && zero.width() > kZeroShare && now != 0; ++k) {
    share = next;
    if (!valueAt(island, h, share, which, now)) return false;
    next = zero.after(share, now);
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

/// The share between two at which a row that is open at both, mode.earlier and mode.event, is
/// nearest, if it is closed there: it would be left again unseen. kNeverTouched: there is none.
double shareOfGraze(Island& island, double h, double before, double share) {
  Mode& mode = island.s.mode;
  // Two sides may come to each other so fast.
  const double approach = 2 * std::max(fastest(island, mode.start), fastest(island, mode.end));
  const double reach = (share - before) * h * approach;
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

/// Moves mode.end to an event of the motion over h. time: [s] of it. False: it is not found.
bool moveTo(Island& island, double h, const ModeEvent& found, double& time) {
  Mode& mode = island.s.mode;
  const Event event = static_cast<Event>(found.which % kEventsOfRow);
  const double lo = std::max(0.0, found.share - kSlopeShare);
  const double hi = std::min(1.0, lo + 2 * kSlopeShare);
  double first = 0, second = 0;
  if (event == kGap) {
    if (!valueAt(island, h, 0.5 * found.share, found.which, first)) return false;
    forgetNoise(mode.rows[found.which / kEventsOfRow], first);
  }
  if (!valueAt(island, h, lo, found.which, first) || !valueAt(island, h, hi, found.which, second))
    return false;
  ZeroSearch zero(h, (second - first) / ((hi - lo) * h));
  time = found.share * h;
  for (int k = 0; k < kEventRefinements; ++k) {
    if (!moveInMode(island, time, mode.end, mode.piece) || !accelerateInMode(island, mode.end))
      return false;
    const double value = eventValue(island, found.which / kEventsOfRow, event, mode.end);
    const double next = zero.after(time, value);
    // Not zero, and not on the way there: a motion beyond what the piece can follow told of it.
    if (std::isnan(next)) return h < kEventNear;
    if (value == 0 || std::abs(next - time) < kEventTime) return true;
    time = next;
  }
  return false;
}

/// Whether what closes is not overlapped by mode.end, but for rounding: a stick's end closes as the
/// place where the stick touches runs there.
bool barelyCloses(Island& island, const ModeEvent& found) {
  return found.which % kEventsOfRow == kGap &&
         eventValue(island, found.which / kEventsOfRow, kGap, island.s.mode.end) > -kClosedGap;
}

}  // namespace

bool findModeEvent(Island& island, double h, ModeEvent& found) {
  Mode& mode = island.s.mode;
  found = {};
  for (ModeRow& row : mode.rows) row.gap_noise = row.gap_start < kClosedGap ? kGapNoise : 0;
  if (!eventsAt(island, mode.start, mode.earlier)) return false;
  if (!accelerateInMode(island, mode.end)) return false;  // the polynomial takes them
  double before = 0;
  mode.sample = mode.end;
  for (int k = 1; k <= kEventSamples && !found.any; ++k) {
    double share = k / static_cast<double>(kEventSamples);
    ModePoint& point = k < kEventSamples ? mode.sample : mode.end;
    if (k < kEventSamples) interpolate(mode.start, mode.end, h, share, point);
    if (!eventsAt(island, point, mode.event)) return false;
    for (std::size_t i = 0; i < mode.rows.size(); ++i)
      forgetNoise(mode.rows[i], mode.event[kEventsOfRow * i + kGap]);
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

bool moveToModeEvent(Island& island, double h, ModeEvent found, double& time) {
  for (int tries = 0; tries < kEventRefinements; ++tries) {
    if (!moveTo(island, h, found, time) || !findModeEvent(island, time, found)) return false;
    if (!found.any || (1 - found.share) * time < kEventNear || barelyCloses(island, found))
      return true;
    h = time;
  }
  return false;
}

}  // namespace ragdoll
