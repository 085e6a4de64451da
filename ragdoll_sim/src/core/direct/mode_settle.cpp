#include "core/direct/mode_settle.h"

#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/mode_constants.h"
#include "core/direct/mode_motion.h"
#include "core/direct/mode_rows.h"

namespace ragdoll {
namespace {

using Kind = ModeRow::Kind;

/// mode.stage <- a moment after mode.start.
void lookAhead(Mode& mode) {
  mode.stage.v = mode.start.v + kMoment * mode.start.a;
  mode.stage.x = mode.start.x + kMoment * mode.start.v;
}

/// Whether a spring presses from mode.start on: it does at mode.stage.
void settleSpring(Body& body, ModeRow& row) {
  const ModePoint &now = body.mode.start, &ahead = body.mode.stage;
  row.gap_start = openingOf(body, row, now.x.data(), now.v.data());
  row.presses = row.closed = openingOf(body, row, ahead.x.data(), ahead.v.data()) < 0;
}

/// What touches at mode.start; whether some of it approaches. pressed: what pressed in the last step
/// may be a little off. leaves: what opens counts as closed, too; an impact may close it.
void findClosed(Body& body, bool pressed, bool leaves, bool& impact) {
  Mode& mode = body.mode;
  impact = false;
  lookAhead(mode);
  for (ModeRow& row : mode.rows) {
    row.closed = false;
    if (row.isSoft()) {
      settleSpring(body, row);
      continue;
    }
    row.gap_start = gapOf(body, row, mode.start.x.data());
    double close = kClosedGap;
    if (pressed && row.gap_start < kTouching / kLever) close = kTouching;
    if (row.gap_start >= close) continue;
    const RowPlace place = placeOf(body, row, mode.start.x.data(), mode.start.v.data(), false);
    if (!place.inside || !place.regular) continue;
    if (pressed && row.gap_start >= kClosedGap) {
      const CachedImpulse* last = row.kind == Kind::kLimit ? body.cache.find(place.limit)
                                                           : body.cache.find(place.contact);
      const double touching = row.kind == Kind::kLimit ? body.tolerances.touching_angle
                                                       : body.tolerances.touching;
      if (!last || row.gap_start >= touching) continue;
    }
    const double rate = rateOf(row, place, body, mode.start.v.data());
    row.closed = leaves || rate <= kLeaving;
    impact = impact || rate < -kRestApproach;
  }
}

/// Closes rows that open, and would close again before they are open by kChatterGap: where two rows
/// open each other in turn there is no end to it. Whether there are any.
bool closeChatter(Body& body) {
  Mode& mode = body.mode;
  const ModePoint& now = mode.start;
  bool any = false;
  for (ModeRow& row : mode.rows) {
    if (row.closed || row.isSoft() || row.gap_start >= kClosedGap) continue;
    const RowPlace place = placeOf(body, row, now.x.data(), now.v.data(), true);
    if (!place.inside || !place.regular) continue;
    const double rate = rateOf(row, place, body, now.v.data());
    const double back = -rateOf(row, place, body, now.a.data()) - place.curvature;
    if (!(back > 0) || rate * rate > 2 * kChatterGap * back) continue;
    row.closed = any = true;
  }
  return any;
}

}  // namespace

bool settleMode(Body& body, bool pressed) {
  Mode& mode = body.mode;
  bool impact = false;
  findClosed(body, pressed, false, impact);
  if (impact) {
    findClosed(body, pressed, true, impact);
    if (!takeModeImpact(body, mode.start)) return false;
    ++body.located;
    findClosed(body, pressed, false, impact);
    if (impact) return false;
  }
  if (!findMode(body, mode.start)) return false;
  for (int k = 0; k < kModeProjections && closeChatter(body); ++k)
    if (!findMode(body, mode.start)) return false;
  return projectPositions(body, mode.start) &&
         projectVelocities(body, mode.start, true) && accelerateInMode(body, mode.start);
}

}  // namespace ragdoll
