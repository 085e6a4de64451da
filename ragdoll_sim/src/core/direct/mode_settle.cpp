#include "core/direct/mode_settle.h"

#include <algorithm>

#include "core/direct/constants.h"
#include "core/direct/contact_motion.h"
#include "core/direct/mode_constants.h"
#include "core/direct/mode_motion.h"
#include "core/direct/mode_obstacles.h"
#include "core/direct/mode_rows.h"
#include "core/direct/mode_slow_slips.h"
#include "core/direct/tolerances.h"

namespace ragdoll {
namespace {

/// A moment after mode.start, until the next stage of a piece.
const ModePoint& lookAhead(Mode& mode) {
  mode.stage.v = mode.start.v + kMoment * mode.start.a;
  mode.stage.x = mode.start.x + kMoment * mode.start.v;
  return mode.stage;
}

/// Whether a spring presses from mode.start on, and between two sticks at which ends: it does so a
/// moment later.
void settleSpring(Island& island, const ModePoint& ahead, ModeRow& row) {
  const ModePoint& now = island.s.mode.start;
  row.presses = false;
  row.gap_start = openingOf(island, row, now.x.data(), now.v.data());
  row.closed = openingOf(island, row, ahead.x.data(), ahead.v.data()) < 0;
  if (row.closed && (row.kind == ModeRow::Kind::kPair || !row.isContact()))
    row.feature = placeOf(island, row, ahead.x.data(), ahead.v.data(), false).feature;
  row.presses = row.closed;
}

/// Whether the place of a stick comes to be within it over the end at which it is. One that lies
/// flat is anywhere, and may be at the other end.
bool comesFrom(const ModeRow& row, const RowPlace& place, const RowPlace& later) {
  return row.kind == ModeRow::Kind::kStick && std::abs(later.at - place.at) < 0.5;
}

/// Whether it touches within its sticks a moment later: where the place comes to a stick's end,
/// what is the end's takes that of what is the stick's, or the other way round. In an impact, which
/// changes what the next moment is, a stick touches where it does: one that lies flat may turn
/// about the one place before it, and about the other after it.
bool staysWithin(Island& island, const ModePoint& ahead, const ModeRow& row, const RowPlace& place,
                 bool in_impact) {
  if (!place.regular) return false;
  if (in_impact && row.kind == ModeRow::Kind::kStick && place.inside) return true;
  if (row.kind == ModeRow::Kind::kParticle)
    return !passesToStick(island, row, island.s.mode.start.x.data(), ahead.x.data());
  if (row.kind != ModeRow::Kind::kStick && row.kind != ModeRow::Kind::kPair) return true;
  const RowPlace later = placeOf(island, row, ahead.x.data(), ahead.v.data(), false);
  return later.inside && (place.inside || comesFrom(row, place, later));
}

/// Below which gap a row touches. In an impact, which may close what the one before has opened: as
/// in the smallest steps of shake. Where impacts follow each other within a microsecond it matters
/// what is still in the next one, and two measures of that would give the methods two limits.
double closeness(const ModeRow& row, bool in_impact) {
  if (!in_impact) return kClosedGap;
  const Tolerances smallest = tolerancesFor(0);
  return row.isContact() ? smallest.touching : smallest.touching_angle;
}

/// Whether a row is of two capsules, or of ends of them.
bool isWithin(const ModeRow& row, const ModeRow& capsules) {
  const auto isEnd = [](int particle, int a, int b) { return particle == a || particle == b; };
  return isEnd(row.a, capsules.a, capsules.b) && isEnd(row.b, capsules.a, capsules.b) &&
         isEnd(row.c, capsules.c, capsules.d) && isEnd(row.d, capsules.c, capsules.d);
}

/// Whether the two capsules of a row touch elsewhere: what pressed between them did so there.
bool touchesElsewhere(Island& island, const ModeRow& row) {
  if (row.kind != ModeRow::Kind::kPair) return false;
  const ModePoint& now = island.s.mode.start;
  const std::vector<ModeRow>& rows = island.s.mode.rows;
  return std::any_of(rows.begin(), rows.end(), [&](const ModeRow& other) {
    return &other != &row && other.kind == row.kind && other.body == row.body &&
           other.other == row.other && (isWithin(row, other) || isWithin(other, row)) &&
           gapOf(island, other, now.x.data()) < kClosedGap &&
           placeOf(island, other, now.x.data(), now.v.data(), false).inside;
  });
}

/// Whether a stick has come to lie across a box: it would strike one edge as if it had left the
/// other.
bool anyLiesAcross(const Island& island) {
  const Mode& mode = island.s.mode;
  return std::any_of(mode.rows.begin(), mode.rows.end(), [&](const ModeRow& row) {
    return row.kind == ModeRow::Kind::kStick && !row.isSoft() &&
           liesAcross(*island.bodies[row.body], row, mode.start.x.data() + mode.offset[row.body]);
  });
}

/// What touches at mode.start; returns whether some of it approaches. ahead: a moment later.
/// pressed: what pressed in the last step may be a little off. in_impact: what opens counts as
/// closed, too; an impact may close it.
bool findClosed(Island& island, const ModePoint& ahead, bool pressed, bool in_impact) {
  Mode& mode = island.s.mode;
  bool impact = false;
  for (ModeRow& row : mode.rows) {
    row.closed = false;
    if (row.isSoft()) {
      settleSpring(island, ahead, row);
      continue;
    }
    row.gap_start = gapOf(island, row, mode.start.x.data());
    const double close = closeness(row, in_impact);
    const bool may_be_off = pressed && row.gap_start < kTouching / kLever;
    if (row.gap_start >= (may_be_off ? kTouching : close)) continue;
    const RowPlace place = placeOf(island, row, mode.start.x.data(), mode.start.v.data(), false);
    if (!staysWithin(island, ahead, row, place, in_impact)) continue;
    if (pressed && row.gap_start >= close) {
      const Tolerances& tolerances = island.context.tolerances;
      const double touching = row.isContact() ? tolerances.touching : tolerances.touching_angle;
      if (row.gap_start >= touching || !hasPressed(island, row, place) ||
          touchesElsewhere(island, row))
        continue;
    }
    const double rate = rateOf(island, row, place, mode.start.v.data());
    row.closed = in_impact || rate <= kLeaving;
    impact = impact || rate < -kRestApproach;
  }
  return impact;
}

/// Closes rows that open, and would close again before they are open by kChatterGap, wherever on
/// the way they are: where two rows open each other in turn there is no end to it. Whether there
/// are any.
bool closeChatter(Island& island, const ModePoint& ahead) {
  Mode& mode = island.s.mode;
  const ModePoint& now = mode.start;
  bool any = false;
  for (ModeRow& row : mode.rows) {
    if (row.closed || row.isSoft() || row.gap_start >= kClosedGap) continue;
    const RowPlace place = placeOf(island, row, now.x.data(), now.v.data(), true);
    if (!staysWithin(island, ahead, row, place, false)) continue;
    const double rate = rateOf(island, row, place, now.v.data());
    const double back = -openingRateOf(island, row, place, now.a.data()) - place.curvature;
    const double room = kChatterGap - std::max(0.0, row.gap_start);
    if (!(back > 0) || rate * rate > 2 * room * back) continue;
    row.closed = any = true;
  }
  return any;
}

/// Impacts of what touches at mode.start, and what touches after them. Where energy is taken out,
/// or a couple comes back as a spin, what has opened may approach again.
bool settleImpact(Island& island, const ModePoint& ahead, bool pressed) {
  for (int k = 0; k < kModeProjections; ++k) {
    findClosed(island, ahead, pressed, true);
    if (!takeModeImpact(island, island.s.mode.start)) return false;
    for (Body* body : island.bodies) ++body->located;
    lookAhead(island.s.mode);
    if (!findClosed(island, ahead, pressed, false)) return true;
  }
  return false;
}

/// The mode of what touches, and positions and velocities as it has them. What hops and is not to
/// comes to rest, and all that is closed with it: else it would push what depends on it into what
/// it touches. Of speeds that are left the mode may be another one.
bool findModeAtRest(Island& island, const ModePoint& ahead, bool pressed) {
  Mode& mode = island.s.mode;
  if (!findMode(island, mode.start)) return false;
  bool chatters = false;
  for (int k = 0; k < kModeProjections && closeChatter(island, ahead); ++k) {
    chatters = true;
    if (!findMode(island, mode.start)) return false;
  }
  if (!projectPositions(island, mode.start)) return false;
  if (chatters) {
    for (ModeRow& row : mode.rows)
      if (!row.isSoft()) row.presses = row.closed;
    if (!projectVelocities(island, mode.start, true)) return false;
    lookAhead(mode);
    findClosed(island, ahead, pressed, false);
    if (!findMode(island, mode.start)) return false;
  }
  return projectVelocities(island, mode.start, true);
}

/// Whether something closed approaches, too slowly to bounce, and nothing presses there, as what
/// else touches turns it back later: it would sink in until then.
bool anyApproachesFree(Island& island) {
  const ModePoint& now = island.s.mode.start;
  const std::vector<ModeRow>& rows = island.s.mode.rows;
  return std::any_of(rows.begin(), rows.end(), [&](const ModeRow& row) {
    if (!row.closed || row.presses || row.isSoft()) return false;
    const RowPlace place = placeOf(island, row, now.x.data(), now.v.data(), false);
    return rateOf(island, row, place, now.v.data()) < -kLeaving;
  });
}

}  // namespace

bool settleMode(Island& island, bool pressed) {
  Mode& mode = island.s.mode;
  clearSlowSlips(mode);
  for (ModeRow& row : mode.rows)
    if (!row.isContact()) row.presses = row.presses && row.isSoft();  // at no border yet
  const ModePoint& ahead = lookAhead(mode);
  if (anyLiesAcross(island)) return false;
  bool impact = findClosed(island, ahead, pressed, false);
  for (int k = 0; k < 2; ++k) {
    if (impact && !settleImpact(island, ahead, pressed)) return false;
    if (!findModeAtRest(island, ahead, pressed)) return false;
    impact = anyApproachesFree(island);
    if (!impact) break;
  }
  return accelerateInMode(island, mode.start);
}

}  // namespace ragdoll
