#include "core/direct/mode_events.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/direct/constants.h"
#include "core/direct/contact_log.h"
#include "core/direct/contact_motion.h"
#include "core/direct/dormand_prince.h"
#include "core/direct/driving.h"
#include "core/direct/mode_constants.h"
#include "core/direct/mode_event_search.h"
#include "core/direct/mode_list.h"
#include "core/direct/mode_motion.h"
#include "core/direct/mode_piece.h"
#include "core/direct/mode_rows.h"
#include "core/direct/mode_settle.h"
#include "core/direct/mode_slow_slips.h"
#include "core/direct/spring.h"
#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

/// What a spring tells of the piece over h from mode.start to mode.end in which it pressed.
void addSpring(Island& island, const ModeRow& row, double h, LoggedImpact& gave) {
  const auto at = [&](ModePoint& point, double& gap, double& rate) {
    const RowPlace place = placeOf(island, row, point.x.data(), point.v.data(), false);
    gap = place.gap;
    rate = rateOf(island, row, place, point.v.data());
    return place.contact;
  };
  SpringMotion m;
  m.h = h;
  m.answer = gave.answer = row.answer;
  at(island.s.mode.start, m.gap[0], m.rate[0]);
  const Contact c = at(island.s.mode.end, m.gap[1], m.rate[1]);
  m.force = gave.impulse.dot(c.normal) / h;
  gave.peak = peakForce(c, m);
  if (m.gap[0] > -island.context.tolerances.touching) gave.approach = std::max(0.0, -m.rate[0]);
}

/// Writes down what pressed over h: of second order, along and at what is between start and end.
void logPiece(Island& island, double h) {
  using namespace dormand_prince;
  if (!isLogged(island) || !(h > 0)) return;
  Mode& mode = island.s.mode;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const ModeRow& row = mode.rows[i];
    if (!row.presses || !row.isContact()) continue;
    const auto contactAt = [&](ModePoint& point) {
      return placeOf(island, row, point.x.data(), point.v.data(), false).contact;
    };
    const Contact before = contactAt(mode.start);
    const Contact c = contactAt(mode.end);
    LoggedImpact gave;
    double pressed = 0, late = 0;
    for (int k = 0; k < kStages; ++k) {
      const double press = h * kB[k] * mode.piece.forces[k].normal[i];
      pressed += press;
      late += kC[k] * press;
      gave.impulse += press * (before.normal + kC[k] * (c.normal - before.normal)) +
                      h * kB[k] * mode.piece.forces[k].friction[i];
    }
    if (row.isSoft()) addSpring(island, row, h, gave);
    if (pressed > 0) {
      const double early = 1 - std::clamp(late / pressed, 0.0, 1.0);
      gave.back = early * (pointOf(island, before, mode.start.x.data()) -
                           pointOf(island, c, mode.end.x.data()));
      gave.turn = early * (before.normal - c.normal);
    }
    logImpulse(island, c, gave, mode.end.x.data(), mode.end.v.data());
  }
}

/// What presses at the end goes into the caches, as leapfrog's impulses per h^2 are half the force.
void keepPressing(Island& island, int& contacts) {
  Mode& mode = island.s.mode;
  PairSet& pairs = island.pairs;
  for (Body* body : island.bodies) body->cache.clear();
  pairs.cache.clear();
  pairs.pressing.clear();
  contacts = 0;
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const ModeRow& row = mode.rows[i];
    if (!row.presses) continue;
    const RowPlace place = placeOf(island, row, mode.start.x.data(), mode.start.v.data(), false);
    const double half = 0.5 * mode.start.forces.normal[i];
    ImpulseCache& cache = row.isShared() ? pairs.cache : island.bodies[row.body]->cache;
    if (!row.isContact()) {
      cache.add(keyOf(place.limit));
      cache.last().impulse = Vec3(half, 0, 0);
      continue;
    }
    ++contacts;
    if (row.isShared())
      pairs.pressing.push_back({place.contact.ragdoll, place.contact.other, row.sticks});
    else if (row.sticks && place.contact.obstacle >= 0)
      cache.setGripped();
    cache.add(keyOf(place.contact));
    cache.last().impulse = half * place.contact.normal + 0.5 * mode.start.forces.friction[i];
  }
}

/// [m/s^2] Of a body, by all that presses on it but its sticks. In the body's scratch.
const Points& findAccelerations(Island& island, int k) {
  Mode& mode = island.s.mode;
  Body& body = *island.bodies[k];
  Points& free = body.v1;
  drive(body, mode.start.x.data() + mode.offset[k], mode.start.v.data() + mode.offset[k], free);
  const auto push = [&](int particle, const Vec3& force) {
    const int own = particle - body.first;
    if (own >= 0 && own < body.n) body.memory->response.push(own, force, free);
  };
  for (std::size_t i = 0; i < mode.rows.size(); ++i) {
    const ModeRow& row = mode.rows[i];
    if (!row.presses || (row.body != k && !(row.isShared() && row.other == k))) continue;
    const RowPlace place = placeOf(island, row, mode.start.x.data(), mode.start.v.data(), false);
    if (!row.isContact())
      for (int j = 0; j < place.limit.count; ++j)
        push(place.limit.particle[j], mode.start.forces.normal[i] * place.limit.gradient[j]);
    else
      for (int j = 0; j < place.contact.count; ++j)
        push(place.contact.particle[j],
             place.contact.weight[j] * (mode.start.forces.normal[i] * place.contact.normal +
                                        mode.start.forces.friction[i]));
  }
  return free;
}

/// The sticks' multipliers under all that presses, for the guard and the next free motion.
void keepMultipliers(Island& island) {
  Mode& mode = island.s.mode;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    Body& body = *island.bodies[k];
    const int offset = mode.offset[k];
    BodyResponse& response = body.memory->response;
    response.setFree(findAccelerations(island, static_cast<int>(k)));
    response.setEnd(mode.start.x.data() + offset);
    const Eigen::VectorXd& lambda =
        response.accelerate(true, mode.start.v.data() + offset, mode.start.a.data() + offset);
    double* m = body.multipliers();
    for (int j = 0; j < body.rows->s; ++j) m[j] = m[j + body.rows->s] = 0.5 * lambda[j];
  }
}

/// Sleepers are in no mode.
bool isFit(const Island& island) {
  if (!island.context.events || island.s.all.size() != island.bodies.size()) return false;
  return std::all_of(island.bodies.begin(), island.bodies.end(), [](const Body* body) {
    return body->isWhole() && body->overlaps == OverlapPolicy::kResolve;
  });
}

/// What pieces of a motion over h may err by.
class PieceErrors {
 public:
  PieceErrors(const Island& island, double h)
      : tolerance_(island.context.isPart() ? island.context.model.solver.tolerance : 0),
        spare_((1 - kReserved) * tolerance_ * h) {}

  /// [m/s] Of a piece over that time: within a tolerance its share, and some of what is spare, for
  /// what no shorter piece does better, as where a slip begins.
  double allowed(double took) const {
    return std::max(kPieceError, (kReserved * tolerance_ * took + kOfSpare * spare_) / kSwingTime);
  }

  /// [m/s] Across slow slips: it stays, as friction does not turn them.
  double allowedAcross() const { return kSlowShare * tolerance_; }

  void add(double error, double took) {
    sum_ += kSwingTime * error;
    spare_ -= std::max(0.0, kSwingTime * error - kReserved * tolerance_ * took);
  }

  double sum() const { return sum_; }  ///< [m]

 private:
  double tolerance_, spare_, sum_ = 0;
};

/// How much longer or shorter a piece with the formula's error is to be.
double shareOf(double error, double allowed) {
  return error > 0 ? kPieceAim * std::pow(allowed / error, 1.0 / kOrderOfPiece) : kGrowth;
}

/// Moves mode.end over a piece of at most `most` in the present mode, to its first event if there
/// is one. Where an event comes early the motion beyond it, in a mode that has ended, says little
/// about when: it is looked for again in a shorter piece. Where no motion is known at once, as rows
/// that depend on each other contradict each other, the mode has ended at the start (with slow
/// slips it may be these). pieces: how many may be tried. next: [s] what the one after it may be.
bool takePiece(Island& island, double most, PieceErrors& errors, int& pieces, double& took,
               double& next, bool& event) {
  Mode& mode = island.s.mode;
  double piece = most;
  for (int k = 0; k < kShorterPieces && pieces > 0; ++k, --pieces) {
    ModeEvent found;
    const bool known =
        moveInMode(island, piece, mode.end, mode.piece) && findModeEvent(island, piece, found);
    if (!known && piece < kEventTime && mode.slow.rows.empty()) {
      mode.end = mode.start;
      mode.piece.work = took = 0;
      return event = true;
    }
    took = piece;
    event = found.any;
    const bool early = known && event && found.share <= kEarly && !(piece < kEventNear);
    double shorter = kShorterPiece;
    if (early) {
      shorter = std::clamp(3 * found.share, kShorterPiece * kShorterPiece, kShorterPiece);
    } else if (known && (!event || moveToModeEvent(island, piece, found, took))) {
      const double error = errorOfPiece(island, took, mode.piece);
      const double share = shareOf(error, errors.allowed(took));
      next = std::min(share, kGrowth) * took;
      if (share >= kPieceAim || piece < kEventNear) {
        errors.add(error, took);
        return true;
      }
      shorter = std::clamp(share * took / piece, kShorterPiece, kHalfPiece);
    }
    piece *= shorter;
  }
  return false;
}

/// What the next piece in the same mode refers to: gaps, and the directions of slips.
void startPiece(Island& island) {
  Mode& mode = island.s.mode;
  const double *x = mode.start.x.data(), *v = mode.start.v.data();
  for (ModeRow& row : mode.rows) {
    row.gap_start = openingOf(island, row, x, v);
    if (!row.presses || row.sticks || row.impending || !row.isContact() || !(row.friction > 0))
      continue;
    const Vec3 slip = slipOf(island, row, placeOf(island, row, x, v, false), x, v);
    if (slip.norm() > kStill) row.slip = slip.normalized();
  }
}

/// How many pieces of a motion over h may be tried. Within a tolerance events, too: shake's parts
/// are cheaper than many, the fewer the coarser it is.
int mostPieces(const Island& island, double h) {
  if (!island.context.isPart()) return kMostPieces;
  const double tolerance = island.context.model.solver.tolerance;
  const double parts = h / (kShortestPart * std::sqrt(tolerance));
  return kFewPieces + static_cast<int>(std::min<double>(kMostPieces, kPiecesOfParts * parts));
}

/// went: [m] as far as the fastest went, at the most. error: [m] by the formula.
bool takePieces(Island& island, double h, double& went, double& error) {
  Mode& mode = island.s.mode;
  PieceErrors errors(island, h);
  went = 0;
  double left = h, most = h;
  bool pressed = true, event = true;
  int events = 0, pieces = mostPieces(island, h);
  while (pieces > 0) {
    if (event && (++events > kMaxEvents || !settleMode(island, pressed))) return false;
    pressed = false;
    if (!(left > 0)) return true;
    startPiece(island);
    const double longest = std::min(left, mode.longest), usual = std::min(most, longest);
    const bool were_slow = !mode.slow.rows.empty();
    double slow = 0;
    if (!findSlowSlips(island, longest, errors.allowedAcross(), slow)) return false;
    // The piece before was as short as friction turned them, if they are slow now.
    const bool ends_that = !were_slow && !mode.slow.rows.empty();
    double took = 0, next = 0;
    // Where slips stop to be slow within the shortest piece they are followed.
    if (!takePiece(island, std::min(ends_that ? longest : usual, slow), errors, pieces, took, next,
                   event) &&
        !(leaveSlowSlips(island) && takePiece(island, usual, errors, pieces, took, next, event)))
      return false;
    error = errors.sum();
    logPiece(island, took);
    island.bodies[0]->given += mode.piece.work;
    went += took * std::max(fastest(island, mode.start), fastest(island, mode.end));
    std::swap(mode.start, mode.end);
    most = event ? h : next;
    left -= took;
    if (left < kNothingLeft * h) left = 0;
    if (!event && left == 0) return true;
    if (!event || island.context.isPart()) --pieces;
  }
  return false;
}

/// The bodies <- mode.start.
void endMotion(Island& island) {
  const Mode& mode = island.s.mode;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    Body& body = *island.bodies[k];
    std::copy_n(mode.start.x.data() + mode.offset[k], 3 * body.n, body.xData());
    std::copy_n(mode.start.v.data() + mode.offset[k], 3 * body.n, body.vData());
    driveAt(body, body.xData());
    body.motion.dx.setZero(3, body.n);
    body.motion.lambda.setZero(body.rows->width);
    body.touching.clear();
    body.memory->response.setEnd(body.xData());
    body.memory->response.endIsStart();
  }
  island.pairs.touching.clear();
}

/// What pieces change beside mode.start, to take them back.
class BeforeMode {
 public:
  explicit BeforeMode(const Island& island)
      : given_(island.bodies[0]->given),
        logged_(logSize(island)),
        met_(island.pairs.met.size()),
        located_(island.bodies[0]->located) {}

  void restore(Island& island) const {
    island.bodies[0]->given = given_;
    for (Body* body : island.bodies) {
      body->located = located_;
      driveAt(*body, body->xData());
    }
    cutLog(island, logged_);
    island.pairs.met.resize(met_);
  }

 private:
  double given_;
  std::size_t logged_, met_;
  int located_;
};

}  // namespace

bool moveThroughEvents(Island& island, double h, int& contacts, double& error) {
  if (!isFit(island)) return false;
  const BeforeMode before(island);
  double reach = reachOf(island, h), went = 0;
  for (int list = 0; list < kMostLists && startMode(island, reach); ++list) {
    const bool taken = takePieces(island, h, went, error);
    if (taken && went <= reach) {
      keepPressing(island, contacts);
      keepMultipliers(island);
      endMotion(island);
      return true;
    }
    before.restore(island);
    if (!taken) return false;
    reach = kReach * went;  // a limb that is hit near a joint is whipped: what it met is not all
  }
  return false;
}

}  // namespace ragdoll
