#include "core/direct/position_solver.h"

#include <algorithm>
#include <limits>

#include "core/direct/angular_momentum.h"
#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/impact.h"
#include "core/direct/motion.h"
#include "core/direct/rows.h"
#include "core/linear/constants.h"

namespace ragdoll {
namespace {

bool hasCandidates(const Island& island) {
  return !island.pairs.contacts.empty() ||
         std::any_of(island.bodies.begin(), island.bodies.end(), [](const Body* body) {
           return !body->constraints.contacts.empty() || !body->constraints.limits.empty();
         });
}

void forgetImpulses(Island& island) {
  for (Body* body : island.bodies) body->cache.clear();
  island.pairs.cache.clear();
  island.pairs.pressing.clear();
}

/// [m] What is violated.
double violationOf(Island& island) { return worstResidual(island, false); }

void assemble(Island& island, bool at_end) {
  for (Body* body : island.bodies) {
    BodyMemory& memory = *body->memory;
    if (at_end) memory.response.setEnd(poseAfter(*body).data() + 3 * body->first);
    if (!memory.schur.empty()) memory.response.assemble(memory.schur, at_end);
  }
}

/// The impulses that are gone on from: as many as there are rows.
void startTotals(Island& island) {
  island.s.total.setZero(island.s.joint.size());
  island.s.joint.split(island.s.total, island.s.parts);
  for (std::size_t k = 0; k < island.bodies.size(); ++k)
    island.bodies[k]->total = island.s.parts[k];
}

/// Whether sweeps that do not settle are accelerated. Each leaves 1 - m / M of what presses through
/// a body of m under one of M, and they are kMaxSweeps.
bool pressesThroughLight(const Island& island) {
  if (island.isLone() || island.context.relaxed) return false;
  double lightest = std::numeric_limits<double>::infinity(), heaviest = 0;
  for (const Body* body : island.bodies) {
    const double mass = body->rows->mass.sum();
    lightest = std::min(lightest, mass);
    heaviest = std::max(heaviest, mass);
  }
  return kMaxSweeps * lightest < heaviest;
}

struct Round {
  bool fresh = true;       ///< nothing has pressed yet: gaps are those of the free motion
  bool at_start = true;    ///< along the directions at the start
  bool on_and_on = false;  ///< sweeps that do not settle are accelerated
};

/// Moves the bodies by what the impulses p are beyond s.total, which they become. False: sticks
/// cannot follow.
bool applyImpulses(Island& island, const RowValues& p, bool at_start) {
  IslandScratch& s = island.s;
  s.change = p - s.total;
  s.joint.split(s.change, s.parts);
  s.total = p;
  bool whole = true;
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    Body& body = *island.bodies[k];
    Schur& schur = body.memory->schur;
    if (schur.empty()) continue;
    schur.move(s.parts[k], body.motion.dx.data());
    whole = ((at_start && satisfySticks(body)) || satisfySticksAlongNew(body)) && whole;
  }
  s.joint.split(s.total, s.parts);
  for (std::size_t k = 0; k < island.bodies.size(); ++k) island.bodies[k]->total = s.parts[k];
  return whole;
}

/// Solves the rows from their gaps b and the impulses p to begin with, and moves the bodies. False:
/// sticks cannot follow, or there is no way out.
bool solveRound(Island& island, const Round& round, RowValues& b, RowValues& p) {
  const auto [fresh, at_start, on_and_on] = round;
  IslandScratch& s = island.s;
  if (!fresh) {
    s.joint.split(s.total, s.parts);
    s.joint.addAnswer(-1, s.parts, b);
  }
  Sweeping sweeps = sweepsOf(island, Sweeps::kToTheEnd);
  sweeps.contradiction = island.context.tolerances.touching;
  const bool settled = s.joint.solve(b, p, sweeps) || (on_and_on && s.joint.solveOn(b, p));
  if (!settled && island.isLone() && hasNoWayOut(*island.bodies[0])) return false;
  return applyImpulses(island, p, at_start);
}

/// Solves for the candidates that are rows.
bool solveRows(Island& island, double h) {
  IslandScratch& s = island.s;
  RowValues &b = s.b, &p = s.p;
  buildRows(island, true);
  startTotals(island);
  if (s.joint.size() == 0) return true;
  const CommonTurns& turns = evaluateGaps(island, h, b);
  if (!anyCloses(island, b)) return true;
  assemble(island, false);
  if (soften(island, h, true)) evaluateGaps(island, h, b);
  warmStart(island, h, p);
  const bool started = turns.any();  // their turn by friction is in no row's answer
  if (started && !applyImpulses(island, p, true)) return false;
  const bool on_and_on = pressesThroughLight(island);
  double violation = 0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const bool fresh = round == 0 && !started;
    if (!fresh) {
      evaluateGaps(island, h, b);
      p = s.total;
    }
    if (!solveRound(island, {fresh, true, on_and_on}, b, p)) return false;
    const double now = worstResidual(island, true);
    // What has not pressed before did not count among those that turn together: their slip does.
    if (now < island.context.tolerances.contact && !turnsAnew(island)) return true;
    if (round > 1 && now > kSlop && now > kProgress * violation) return true;
    violation = now;
  }
  return true;
}

/// Solves for all candidates, along the directions at the end.
bool solveRowsImplicitly(Island& island, double h) {
  IslandScratch& s = island.s;
  activateAll(island);
  buildRows(island, false);
  startTotals(island);
  // Bodies that relaxation moves sank in more with it, as with leaps (sweepsOf).
  const bool on_and_on =
      island.bodies[0]->overlaps == OverlapPolicy::kResolve && !island.context.relaxed;
  double violation = violationOf(island);
  bool done = violation < island.context.tolerances.contact;
  for (int round = 0; round < kImplicitRounds && !done; ++round) {
    buildRows(island, false);
    if (s.total.size() != s.joint.size()) startTotals(island);  // other rows
    assemble(island, true);
    soften(island, h, false);
    evaluateGaps(island, h, s.b);
    s.p = s.total;
    if (!solveRound(island, {round == 0, false, on_and_on}, s.b, s.p)) return false;
    const double now = violationOf(island);
    done = now < island.context.tolerances.contact;
    if (!done && round > 1 && now > kProgress * violation) break;
    violation = now;
  }
  return violationOf(island) <= kSlop;
}

int countContacts(const Island& island) {
  int contacts = 0;
  for (int i = 0; i < island.s.joint.size(); ++i)
    if (island.s.joint.row(i).kind == Schur::Row::Kind::kNormal && island.s.total[i] > 0)
      ++contacts;
  return contacts;
}

}  // namespace

bool solvePositions(Island& island, double h, int& contacts) {
  if (!hasCandidates(island)) {
    forgetImpulses(island);
    return true;
  }
  for (Body* body : island.bodies) body->free = body->motion;
  for (int search = 0;; ++search) {
    if (!solveRows(island, h)) return false;
    const bool violated = activateViolated(island);
    // What is reached on the way cuts the motion short: what lies beyond is not met.
    const bool missed = !reachesComing(island) && findMissed(island, h);
    if (!violated && !missed) break;
    if (search + 1 == kMaxSearches) return false;         // smaller steps meet fewer things at once
    if (search + 2 == kMaxSearches) activateAll(island);  // the last one solves for all
    for (Body* body : island.bodies) body->motion = body->free;
  }
  if (violationOf(island) > kSlop) return false;
  contacts += countContacts(island);
  rememberImpulses(island, h);
  return true;
}

bool solvePositionsImplicitly(Island& island, double h) {
  if (!hasCandidates(island)) return true;
  for (Body* body : island.bodies) body->free = body->motion;
  const int searches = island.context.relaxed ? 1 : kMaxSearches;
  for (int search = 0; search < searches; ++search) {
    if (search > 0)
      for (Body* body : island.bodies) body->motion = body->free;
    if (!solveRowsImplicitly(island, h)) return false;
    if (!findMissed(island, h)) {
      rememberImpulses(island, h);
      return true;
    }
  }
  return false;
}

}  // namespace ragdoll
