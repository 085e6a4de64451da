#include "core/direct/mode_events.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/contact_log.h"
#include "core/direct/dormand_prince.h"
#include "core/direct/driving.h"
#include "core/direct/mode_constants.h"
#include "core/direct/mode_motion.h"
#include "core/direct/mode_rows.h"
#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

using Kind = ModeRow::Kind;

/// What a row may do that ends a piece: each a function that is not negative until then.
enum Event { kGap, kForce, kFriction, kPlace, kEventsOfRow };

double rateOf(const ModeRow& row, const RowPlace& place, const Body& body, const double* v) {
  if (row.kind != Kind::kLimit) return place.contact.normal.dot(motionOf(body, place.contact, v));
  double rate = 0;
  for (int k = 0; k < place.limit.count; ++k)
    rate += place.limit.gradient[k].dot(
        Eigen::Map<const Vec3>(v + 3 * (place.limit.particle[k] - body.first)));
  return rate;
}

/// Where the functions are not negative as long as the mode lasts, at a point whose forces are known.
double eventValue(Body& body, std::size_t i, Event event, const ModePoint& point) {
  constexpr double kLasting = 1;
  const ModeRow& row = body.mode.rows[i];
  const double none = 2 * kNoForce * body.mode.force_scale;
  if (event == kGap) {
    if (row.presses) return kLasting;
    const double noise = row.gap_start < kClosedGap ? kGapNoise : 0;
    return gapOf(body, row, point.x.data()) - std::min(0.0, row.gap_start) + noise;
  }
  if (!row.presses) return kLasting;
  if (event == kForce) return point.forces.normal[i] + none;
  if (event == kPlace)
    return std::min(kLasting, roomOf(body, row, point.x.data(), row.feature) + kPlaceNoise);
  if (!(row.friction > 0)) return kLasting;
  if (row.sticks)
    return row.friction * point.forces.normal[i] - point.forces.friction[i].norm() + none;
  const Contact c = placeOf(body, row, point.x.data(), point.v.data(), false).contact;
  return slipOf(body, c, point.v.data()).dot(row.slip) + kSlipNoise;
}

/// Functions at a point, whose accelerations are found if something presses.
bool eventsAt(Body& body, ModePoint& point, std::vector<double>& values) {
  Mode& mode = body.mode;
  if (!accelerateInMode(body, point)) return false;
  values.resize(kEventsOfRow * mode.rows.size());
  for (std::size_t i = 0; i < mode.rows.size(); ++i)
    for (int e = 0; e < kEventsOfRow; ++e)
      values[kEventsOfRow * i + e] = eventValue(body, i, static_cast<Event>(e), point);
  return true;
}

/// Of one of the functions at a share of the motion from mode.start to mode.end.
bool valueAt(Body& body, double h, double share, std::size_t which, double& value) {
  Mode& mode = body.mode;
  const Event event = static_cast<Event>(which % kEventsOfRow);
  interpolate(mode.start, mode.end, h, share, mode.sample);
  if (event != kGap && !accelerateInMode(body, mode.sample)) return false;
  value = eventValue(body, which / kEventsOfRow, event, mode.sample);
  return true;
}

/// Zero between two shares by false position (Illinois [Dowell1971]).
bool findZero(Body& body, double h, std::size_t which, double lo, double open, double hi,
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
    if (!valueAt(body, h, share, which, now)) return false;
    if (now == 0) return true;
    const int side = now > 0 ? 1 : -1;
    (side > 0 ? lo : hi) = share;
    (side > 0 ? open : closed) = now;
    if (side == last) (side > 0 ? closed : open) *= 0.5;
    last = side;
  }
  return true;
}

struct Found {
  bool any = false;
  std::size_t which = 0;
  double share = 1;
};

/// The first event between two shares, of those that are negative at the later one: mode.earlier and
/// mode.event are the functions there.
bool findFirst(Body& body, double h, double before, double share, Found& found) {
  Mode& mode = body.mode;
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
    if (!findZero(body, h, which, before, mode.earlier[which], last, mode.event[which], at))
      return false;
    found = {true, which, at};
    if (at <= before) return true;
    interpolate(mode.start, mode.end, h, at, mode.sample);
    if (!eventsAt(body, mode.sample, mode.event)) return false;
    mode.event[which] = std::max(0.0, mode.event[which]);
    last = at;
  }
  return true;
}

/// The first event of the motion over h.
bool findEvent(Body& body, double h, Found& found) {
  Mode& mode = body.mode;
  found = {};
  if (!eventsAt(body, mode.start, mode.earlier)) return false;
  double before = 0;
  mode.sample = mode.end;
  for (int k = 1; k <= kEventSamples && !found.any; ++k) {
    const double share = k / static_cast<double>(kEventSamples);
    ModePoint& point = k < kEventSamples ? mode.sample : mode.end;
    if (k < kEventSamples) interpolate(mode.start, mode.end, h, share, point);
    if (!eventsAt(body, point, mode.event)) return false;
    if (!findFirst(body, h, before, share, found)) return false;
    std::swap(mode.event, mode.earlier);
    before = share;
  }
  return true;
}

/// Moves mode.end to the event, by motions that end there. time: of it.
bool moveToEvent(Body& body, double h, const Found& found, double& time) {
  Mode& mode = body.mode;
  const Event event = static_cast<Event>(found.which % kEventsOfRow);
  const double lo = std::max(0.0, found.share - kSlopeShare);
  const double hi = std::min(1.0, lo + 2 * kSlopeShare);
  double first = 0, second = 0;
  if (!valueAt(body, h, lo, found.which, first) || !valueAt(body, h, hi, found.which, second))
    return false;
  double slope = (second - first) / ((hi - lo) * h);
  double earlier = 0, value_earlier = 0;
  time = found.share * h;
  for (int k = 0; k < kEventRefinements; ++k) {
    if (!moveInMode(body, time, mode.end) || !accelerateInMode(body, mode.end)) return false;
    const double value = eventValue(body, found.which / kEventsOfRow, event, mode.end);
    if (k > 0 && value != value_earlier && time != earlier)
      slope = (value - value_earlier) / (time - earlier);
    earlier = time;
    value_earlier = value;
    const double change = slope < 0 ? -value / slope : 0;
    if (std::abs(change) < kEventTime || !(slope < 0)) return true;
    if (k + 1 == kEventRefinements) return std::abs(change) < kEventNear;
    time = std::clamp(time + std::clamp(change, -0.1 * h, 0.1 * h), 0.0, h);
    if (time == earlier) return true;
  }
  return false;
}

/// What touches at mode.start; whether some of it approaches. pressed: what pressed in the last step
/// may be a little off. leaves: what opens counts as closed, too; an impact may close it.
void findClosed(Body& body, bool pressed, bool leaves, bool& impact) {
  Mode& mode = body.mode;
  impact = false;
  for (ModeRow& row : mode.rows) {
    row.closed = false;
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
    if (row.closed || row.gap_start >= kClosedGap) continue;
    const RowPlace place = placeOf(body, row, now.x.data(), now.v.data(), true);
    if (!place.inside || !place.regular) continue;
    const double rate = rateOf(row, place, body, now.v.data());
    const double back = -rateOf(row, place, body, now.a.data()) - place.curvature;
    if (!(back > 0) || rate * rate > 2 * kChatterGap * back) continue;
    row.closed = any = true;
  }
  return any;
}

/// The mode at mode.start: impacts first.
bool settle(Body& body, bool pressed) {
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
         projectVelocities(body, mode.start) && accelerateInMode(body, mode.start);
}

/// Writes down what pressed over h.
void logPiece(Body& body, double h) {
  using namespace dormand_prince;
  if (!body.context->log || !(h > 0)) return;
  Mode& mode = body.mode;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const ModeRow& row = mode.rows[i];
    if (!row.presses || row.kind == Kind::kLimit) continue;
    const Contact c =
        placeOf(body, row, mode.end.x.data(), mode.end.v.data(), false).contact;
    LoggedImpact gave;
    for (int k = 0; k < kStages; ++k)
      gave.impulse += h * kB[k] * (mode.stages[k].normal[i] * c.normal + mode.stages[k].friction[i]);
    logImpulse(body, c, gave, mode.end.x.data(), mode.end.v.data());
  }
}

/// What presses at the end goes into the cache, as leapfrog's impulses per h^2 are half the force.
void keepPressing(Body& body, int& contacts) {
  Mode& mode = body.mode;
  body.cache.clear();
  contacts = 0;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const ModeRow& row = mode.rows[i];
    if (!row.presses) continue;
    const RowPlace place = placeOf(body, row, mode.start.x.data(), mode.start.v.data(), false);
    const double half = 0.5 * mode.start.forces.normal[i];
    if (row.kind == Kind::kLimit) {
      body.cache.add(keyOf(place.limit));
      body.cache.last().impulse = Vec3(half, 0, 0);
      continue;
    }
    ++contacts;
    if (row.sticks) body.cache.setGripped();
    body.cache.add(keyOf(place.contact));
    body.cache.last().impulse =
        half * place.contact.normal + 0.5 * mode.start.forces.friction[i];
  }
}

/// The sticks' multipliers under all that presses, for the guard and the next free motion.
void keepMultipliers(Body& body) {
  Mode& mode = body.mode;
  if (forcesFollow(body))
    drive(body, mode.start.x.data(), mode.start.v.data(), mode.free);
  else
    mode.free = body.acceleration;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const ModeRow& row = mode.rows[i];
    if (!row.presses) continue;
    const RowPlace place = placeOf(body, row, mode.start.x.data(), mode.start.v.data(), false);
    const auto push = [&](int particle, const Vec3& force) {
      mode.free.noalias() += force * body.system->W.row(particle - body.first);
    };
    if (row.kind == Kind::kLimit)
      for (int k = 0; k < place.limit.count; ++k)
        push(place.limit.particle[k], mode.start.forces.normal[i] * place.limit.gradient[k]);
    else
      for (int k = 0; k < place.contact.count; ++k)
        push(place.contact.particle[k],
             place.contact.weight[k] * (mode.start.forces.normal[i] * place.contact.normal +
                                        mode.start.forces.friction[i]));
  }
  BodyResponse& response = body.memory->response;
  response.setFree(mode.free);
  response.setEnd(mode.start.x.data());
  const Eigen::VectorXd& lambda =
      response.accelerate(true, mode.start.v.data(), mode.start.a.data());
  double* m = body.multipliers();
  for (int k = 0; k < body.rows->s; ++k) m[k] = m[k + body.rows->s] = 0.5 * lambda[k];
}

/// Within a tolerance parts are halved and compared instead, which takes leapfrog's order.
bool isFit(const Body& body) {
  const SolverSpec& solver = body.context->model.solver;
  if (!solver.events || solver.tolerance > 0) return false;
  if (body.driven || !body.isWhole() || body.overlaps != OverlapPolicy::kResolve) return false;
  for (const Contact& c : body.constraints.contacts)
    if (c.count == 4 && std::min(c.gap_start, gapAfter(body, c)) < kClose) return false;
  return true;
}

/// Whether the motion has met nothing that rows do not stand for.
bool isSound(Body& body) {
  const StepContext& step = *body.context;
  for (const Limit& limit : body.skeleton->limits)
    if (limit.compliance > 0 && limitValue(limit, body.mode.start.x.data()) < 0) return false;
  if (!step.model.self_collision) return true;
  Points& pose = posesOf(step);
  std::copy_n(body.mode.start.x.data(), 3 * body.n, pose.data() + 3 * body.first);
  ConstraintSet& set = body.constraints;
  set.missed.clear();
  body.detector.appendSelf(step.model, step.state.x, pose, body.index, PairSearch::overlaps(0),
                           set.missed);
  return set.missed.empty();
}

/// Whether a slip turned by more than a piece can follow, as it does where it all but ends.
bool slipTurned(Body& body) {
  const Mode& mode = body.mode;
  const auto slipAt = [&](const ModeRow& row, const ModePoint& point) {
    const Contact c = placeOf(body, row, point.x.data(), point.v.data(), false).contact;
    return slipOf(body, c, point.v.data());
  };
  for (const ModeRow& row : mode.rows) {
    if (!row.presses || row.sticks || !(row.friction > 0)) continue;
    Vec3 before = slipAt(row, mode.start);
    if (before.norm() < kStill) before = row.slip;  // it begins
    const Vec3 after = slipAt(row, mode.end);
    if (after.norm() < kStill) continue;
    if (before.dot(after) < kMostSlipTurn * before.norm() * after.norm()) return true;
  }
  return false;
}

/// Moves mode.end over a piece of at most `most` in the present mode, to its first event if there is
/// one. Where an event comes early the motion beyond it, in a mode that has ended, says little about
/// when: it is looked for again in a shorter piece. pieces: how many may be tried.
bool takePiece(Body& body, double most, int& pieces, double& took, bool& event) {
  double piece = most;
  for (int k = 0; k < kShorterPieces && pieces > 0; ++k, --pieces) {
    Found found;
    const bool known = moveInMode(body, piece, body.mode.end) && findEvent(body, piece, found);
    took = piece;
    event = found.any;
    if (known && !event && (piece < kEventNear || !slipTurned(body))) return true;
    if (known && event && (found.share > kEarly || piece < kEventNear) &&
        moveToEvent(body, piece, found, took) && (piece < kEventNear || !slipTurned(body)))
      return true;
    const bool early = known && event && found.share <= kEarly;
    piece *= early ? std::clamp(3 * found.share, kShorterPiece * kShorterPiece, kShorterPiece)
                   : kShorterPiece;
  }
  return false;
}

bool takePieces(Body& body, double h) {
  Mode& mode = body.mode;
  double left = h, most = h;
  bool pressed = true, event = true;
  int events = 0, pieces = kMostPieces;
  while (pieces > 0) {
    if (event && (++events > kMaxEvents || !settle(body, pressed))) return false;
    pressed = false;
    if (!(left > 0)) return true;
    double took = 0;
    if (!takePiece(body, std::min(left, most), pieces, took, event)) return false;
    logPiece(body, took);
    body.given += mode.work;
    std::swap(mode.start, mode.end);
    most = event ? h : kGrowth * took;  // where slips turned they go on turning
    left -= took;
    if (left < kNothingLeft * h) left = 0;
    if (!event && left == 0) return true;
    if (event) continue;
    --pieces;
    for (ModeRow& row : mode.rows) row.gap_start = gapOf(body, row, mode.start.x.data());
  }
  return false;
}

/// Whether the last step was shake's, as its gaps tell, and it is not yet time to try again: where
/// events crowd they do so for a while.
bool waits(Body& body) {
  if (body.context->state.step % kTryEvery == 0) return false;
  for (const ModeRow& row : body.mode.rows) {
    if (row.gap_start > kTouching / kLever || std::abs(row.gap_start) < kGapNoise) continue;
    const RowPlace place = placeOf(body, row, body.xData(), body.vData(), false);
    if (row.kind == Kind::kLimit ? body.cache.find(place.limit) : body.cache.find(place.contact))
      return true;
  }
  return false;
}

}  // namespace

bool moveThroughEvents(Island& island, double h, int& contacts) {
  Body& body = *island.bodies[0];
  Mode& mode = body.mode;
  if (!isFit(body) || !listModeRows(body, h, mode) || waits(body)) return false;
  for (ModePoint* point : {&mode.start, &mode.end, &mode.sample, &mode.stage})
    for (Eigen::VectorXd* values : {&point->x, &point->v, &point->a})
      values->setZero(paddedWidth(3 * body.n));
  std::copy_n(body.xData(), 3 * body.n, mode.start.x.data());
  std::copy_n(body.vData(), 3 * body.n, mode.start.v.data());
  const double given = body.given;
  const int located = body.located;
  const std::size_t logged = logSize(island);
  if (!takePieces(body, h) || !isSound(body)) {
    body.given = given;
    body.located = located;
    cutLog(island, logged);
    driveAt(body, body.xData());
    return false;
  }
  keepPressing(body, contacts);
  keepMultipliers(body);
  std::copy_n(mode.start.x.data(), 3 * body.n, body.xData());
  std::copy_n(mode.start.v.data(), 3 * body.n, body.vData());
  driveAt(body, body.xData());
  body.motion.dx.setZero(3, body.n);
  body.motion.lambda.setZero(body.rows->width);
  body.touching.clear();
  body.memory->response.setEnd(body.xData());
  body.memory->response.endIsStart();
  return true;
}

}  // namespace ragdoll
