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
#include "core/direct/mode_event_search.h"
#include "core/direct/mode_motion.h"
#include "core/direct/mode_rows.h"
#include "core/direct/mode_settle.h"
#include "core/direct/spring.h"
#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

using Kind = ModeRow::Kind;

/// What a spring tells of the piece over h from mode.start to mode.end in which it pressed.
void addSpring(Body& body, const ModeRow& row, double h, LoggedImpact& gave) {
  const auto at = [&](ModePoint& point, double& gap, double& rate) {
    const RowPlace place = placeOf(body, row, point.x.data(), point.v.data(), false);
    gap = place.gap;
    rate = rateOf(row, place, body, point.v.data());
    return place.contact;
  };
  SpringMotion m;
  m.h = h;
  m.answer = gave.answer = row.answer;
  at(body.mode.start, m.gap[0], m.rate[0]);
  const Contact c = at(body.mode.end, m.gap[1], m.rate[1]);
  m.force = gave.impulse.dot(c.normal) / h;
  gave.peak = peakForce(c, m);
  if (m.gap[0] > -body.tolerances.touching) gave.approach = std::max(0.0, -m.rate[0]);
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
    if (row.isSoft()) addSpring(body, row, h, gave);
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
  if (!step.model.self_collision) return true;
  Points& pose = posesOf(step);
  std::copy_n(body.mode.start.x.data(), 3 * body.n, pose.data() + 3 * body.first);
  ConstraintSet& set = body.constraints;
  set.missed.clear();
  body.detector.appendSelf(step.model, step.state.x, pose, body.index, PairSearch::overlaps(0),
                           set.missed);
  return set.missed.empty();
}

/// How much longer or shorter a piece with the formula's error is to be.
double shareOf(double error) {
  return error > 0 ? kPieceAim * std::pow(kPieceError / error, 1.0 / kOrderOfPiece) : kGrowth;
}

/// Moves mode.end over a piece of at most `most` in the present mode, to its first event if there is
/// one. Where an event comes early the motion beyond it, in a mode that has ended, says little about
/// when: it is looked for again in a shorter piece. pieces: how many may be tried. next: [s] what the
/// one after it may be.
bool takePiece(Body& body, double most, int& pieces, double& took, double& next, bool& event) {
  double piece = most;
  for (int k = 0; k < kShorterPieces && pieces > 0; ++k, --pieces) {
    ModeEvent found;
    const bool known = moveInMode(body, piece, body.mode.end) && findModeEvent(body, piece, found);
    took = piece;
    event = found.any;
    const bool early = known && event && found.share <= kEarly && !(piece < kEventNear);
    double shorter = kShorterPiece;
    if (early) {
      shorter = std::clamp(3 * found.share, kShorterPiece * kShorterPiece, kShorterPiece);
    } else if (known && (!event || moveToModeEvent(body, piece, found, took))) {
      const double share = shareOf(errorOfPiece(body, took));
      next = std::min(share, kGrowth) * took;
      if (share >= kPieceAim || piece < kEventNear) return true;
      shorter = std::clamp(share * took / piece, kShorterPiece, kHalfPiece);
    }
    piece *= shorter;
  }
  return false;
}

bool takePieces(Body& body, double h) {
  Mode& mode = body.mode;
  double left = h, most = h;
  bool pressed = true, event = true;
  int events = 0, pieces = kMostPieces;
  while (pieces > 0) {
    if (event && (++events > kMaxEvents || !settleMode(body, pressed))) return false;
    pressed = false;
    if (!(left > 0)) return true;
    double took = 0, next = 0;
    if (!takePiece(body, std::min({left, most, mode.longest}), pieces, took, next, event))
      return false;
    logPiece(body, took);
    body.given += mode.work;
    std::swap(mode.start, mode.end);
    most = event ? h : next;
    left -= took;
    if (left < kNothingLeft * h) left = 0;
    if (!event && left == 0) return true;
    if (event) continue;
    --pieces;
    for (ModeRow& row : mode.rows)
      row.gap_start = openingOf(body, row, mode.start.x.data(), mode.start.v.data());
  }
  return false;
}

/// Whether the last step was shake's, as its gaps tell, and it is not yet time to try again: where
/// events crowd they do so for a while.
bool waits(Body& body) {
  if (body.context->state.step % kTryEvery == 0) return false;
  for (const ModeRow& row : body.mode.rows) {
    if (row.isSoft() || row.gap_start > kTouching / kLever || std::abs(row.gap_start) < kGapNoise) continue;
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
