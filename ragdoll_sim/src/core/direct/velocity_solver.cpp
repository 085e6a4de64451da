#include "core/direct/velocity_solver.h"

#include <algorithm>
#include <cmath>

#include "core/direct/angular_momentum.h"
#include "core/direct/constants.h"
#include "core/direct/contact_log.h"
#include "core/direct/contact_motion.h"
#include "core/direct/contact_path.h"
#include "core/direct/driving.h"
#include "core/direct/exact_rows.h"
#include "core/direct/impact.h"
#include "core/direct/motion.h"
#include "core/direct/rows.h"

namespace ragdoll {
namespace {

using Kind = Schur::Row::Kind;

void buildTouchingRows(Body& body) {
  Schur& schur = body.memory->schur;
  schur.start(body.first);
  for (std::size_t i = 0; i < body.touching.contacts.size(); ++i) {
    const int row = schur.size();
    schur.addContact(body.touching.contacts[i], static_cast<int>(i));
    if (body.touching.contacts[i].isSoft()) schur.give(row);
  }
  for (std::size_t i = 0; i < body.touching.limits.size(); ++i) {
    const int row = schur.size();
    schur.addLimit(body.touching.limits[i], static_cast<int>(i));
    if (body.touching.limits[i].isSoft()) schur.give(row);
  }
  body.constraints.own_rows = schur.size();
}

// Contacts of a body with obstacles and itself, and between bodies, by one path. owner: as in
// contact_motion.h; rows: a body's complement or the joint ones, where theirs begin at row `first`.

/// b <- the rates [m/s] at which they open and slip, beside the turn(contact) of both sides.
template <class Rows, class TurnOfSides>
void evaluateContactRates(const StepContext& step, const TouchingContacts& set, const Rows& rows,
                          int first, const TurnOfSides& turnOf, Eigen::Ref<Eigen::VectorXd> b) {
  int row = first;
  for (const Contact& c : set.contacts) {
    const Vec3 rate = rateOf(step, c) - turnOf(c).cross(c.of(step.state.x));
    for (const int end = row + rowsOf(c); row < end; ++row)
      b[row] = rows.row(row).direction.dot(rate);
  }
}

/// Newton's impact law: b <- rates after the impact, where `bounces`; and the rows are free.
template <class Rows>
void evaluateContactImpacts(const StepContext& step, const TouchingContacts& set, Rows& rows,
                            int first, bool bounces, Eigen::Ref<Eigen::VectorXd> b) {
  int row = first;
  for (const Contact& c : set.contacts) {
    rows.lock(row, false);
    if (bounces && -b[row] > bounceSpeed(step, c)) b[row] *= 1 + c.restitution;
    row += rowsOf(c);
  }
}

/// Whether a contact touches from this motion on.
bool isHitNow(const Contact& c, bool hit, double touching) {
  return !c.isSoft() && (hit || c.before >= touching);
}

/// Whether a contact has not pressed and comes from afar: its impact is still to come, even where
/// the motion has begun within the tolerance of it.
bool isStillToCome(const StepContext& step, const Contact& c, double pressed) {
  return !c.isSoft() && pressed == 0 && -openingRate(step, c) > comingSpeed(step, c);
}

/// Locks contacts that are just hit, at no impulse.
template <class Rows>
void lockHit(const StepContext& step, TouchingContacts& set, Rows& rows, int first) {
  int row = 0;
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const Contact& c = set.contacts[i];
    const int count = rowsOf(c);
    if (isHitNow(c, set.hit[i], step.tolerances.touching) ||
        isStillToCome(step, c, set.warm[row])) {
      rows.lock(first + row, true);
      std::fill_n(set.warm.begin() + row, count, 0.0);
    }
    row += count;
  }
}

/// Limits come after the contacts.
int firstLimitRow(const Body& body) {
  return body.constraints.own_rows - static_cast<int>(body.touching.limits.size());
}

/// The same of limits.
void lockHitLimits(Body& body) {
  TouchingSet& set = body.touching;
  int row = firstLimitRow(body);
  for (std::size_t i = 0; i < set.limits.size(); ++i, ++row) {
    const LimitRow& limit = set.limits[i];
    const bool touched =
        !set.limit_hit[i] && limit.before < body.context->tolerances.touching_angle;
    if (limit.isSoft() || touched) continue;
    body.memory->schur.lock(row);
    set.warm[row] = 0;
  }
}

void lockHit(Island& island, int first_pair) {
  for (Body* body : island.bodies) {
    lockHit(island.context, body->touching, body->memory->schur, 0);
    lockHitLimits(*body);
  }
  lockHit(island.context, island.pairs.touching, island.s.joint, first_pair);
}

/// Locks the contacts that the motion ends just before: they have not pressed and come from afar,
/// and the next substep has their impact.
template <class Rows>
void lockComing(const StepContext& step, const TouchingContacts& set, Rows& rows, int first) {
  int row = 0;
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const Contact& c = set.contacts[i];
    if (isHitNow(c, set.hit[i], step.tolerances.touching) && isStillToCome(step, c, set.warm[row]))
      rows.lock(first + row, true);
    row += rowsOf(c);
  }
}

void lockComing(Island& island, int first_pair) {
  const StepContext& step = island.context;
  for (Body* body : island.bodies) lockComing(step, body->touching, body->memory->schur, 0);
  lockComing(step, island.pairs.touching, island.s.joint, first_pair);
}

/// b <- the rates [m/s], [rad/s] at which the own rows open, beside the body's turn with others.
void evaluateRates(const Body& body, const Vec3& turn, Eigen::Ref<Eigen::VectorXd> b) {
  const Schur& schur = body.memory->schur;
  const auto turnOf = [&turn](const Contact& c) { return commonTurn(turn, c); };
  evaluateContactRates(*body.context, body.touching, schur, 0, turnOf, b);
  for (int i = firstLimitRow(body); i < body.constraints.own_rows; ++i)
    b[i] = schur.along(i, body.vData());
}

/// Of an impact, from the rates before it.
void evaluateImpact(Body& body, bool bounces, Eigen::Ref<Eigen::VectorXd> b) {
  Schur& schur = body.memory->schur;
  evaluateContactImpacts(*body.context, body.touching, schur, 0,
                         bounces && body.located <= kMaxLocated, b);
  for (int i = firstLimitRow(body); i < body.constraints.own_rows; ++i) schur.lock(i, false);
}

/// [N s] of a spring whose row is `row`: what it gave to positions it gives to velocities, or what
/// is left of its last. Implicit steps have given all. gap: [m] at the motion's end.
double springImpulse(const Compliance& give, double before, const SpringRow& spring, double gap,
                     const RowValues& total, int row, double h) {
  const double half = row < total.size() ? total[row] / h : 0;
  const double last = releaseImpulse(give, before, spring, gap, half, h);
  return last > 0 ? last - half : half;
}

/// Impulses of the rows that begin at `row`, over h, along the contact's directions at the end.
Vec3 warmOf(const Contact& c, const RowValues& total, int row, double h, bool leapfrog) {
  if (!(h > 0) || row < 0 || row >= total.size()) return Vec3::Zero();
  Vec3 impulse = Vec3::Zero();
  const int count = rowsOf(c);
  impulse.head(count) = total.segment(row, count) / h;
  return leapfrog ? c.turned(impulse) : impulse;
}

/// Those of the contacts that touch at the end of a motion over h, with what pressed: total.
template <class Owner>
void keepTouching(const Owner& owner, const StepContext& step, const ContactSet& set,
                  const RowValues& total, double h, bool leapfrog, TouchingContacts& kept) {
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const Contact& c = set.contacts[i];
    const int row = i < set.row.size() ? set.row[i] : -1;
    const bool hit = set.role[i] == Role::kHit;
    double spring = 0;
    if (c.isSoft()) {
      if (!leapfrog || !(h > 0) || row < 0) continue;
      spring = springImpulse(c.give, c.before, set.springs[i], gapAfter(owner, c), total, row, h);
      if (!(spring > 0)) continue;
    } else if (gapAfter(owner, c) >= step.tolerances.touching && !hit) {
      continue;
    }
    kept.contacts.push_back(c);
    kept.hit.push_back(hit);
    Contact& end = kept.contacts.back();
    if (leapfrog && h > 0) placeAtEnd(owner, set.contacts, h, end);
    Vec3 warm = warmOf(end, total, row, h, leapfrog);
    if (c.isSoft()) warm[0] = spring;
    for (int k = 0; k < rowsOf(c); ++k) kept.warm.push_back(warm[k]);
  }
}

void keepTouchingLimits(Body& body, double h, bool leapfrog) {
  const ConstraintSet& set = body.constraints;
  if (set.limits.empty()) return;
  LimitAngles::Pose& angles = anglesAfter(body);
  const double* ahead = aheadOf(body);
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    const LimitRow& limit = set.limits[i];
    const int row = h > 0 && i < set.limit_row.size() ? set.limit_row[i] : -1;
    double warm = row >= 0 && row < body.total.size() ? body.total[row] / h : 0.0;
    if (limit.isSoft()) {
      if (!leapfrog || row < 0) continue;
      warm = springImpulse(limit.give(), limit.before, set.limit_springs[i], angles[limit.limit],
                           body.total, row, h);
      if (!(warm > 0)) continue;
    } else if (set.limit_role[i] != Role::kHit &&
               angles.isBeyond(limit.limit,
                               body.context->tolerances.touching_angle - limit.opening)) {
      continue;
    }
    body.touching.limits.push_back(limit);
    body.touching.limit_hit.push_back(set.limit_role[i] == Role::kHit);
    angles.evaluate(body.touching.limits.back(), ahead);
    body.touching.warm.push_back(warm);
  }
}

void findTouchingPairs(Island& island, double h, bool leapfrog) {
  PairSet& pairs = island.pairs;
  pairs.touching.clear();
  keepTouching(island, island.context, pairs, island.s.total, h, leapfrog, pairs.touching);
}

void addTouchingPair(Island& island, int i) {
  const int row = addPairRows(island, island.pairs.touching.contacts[i], i);
  if (island.pairs.touching.contacts[i].isSoft()) island.s.joint.give(row);
}

/// of(body, its number, where its own rows begin).
template <class Of>
void forEachBody(const Island& island, const Of& of) {
  for (std::size_t k = 0; k < island.bodies.size(); ++k)
    of(*island.bodies[k], k, island.s.joint.firstOf(static_cast<int>(k)));
}

/// rates <- as they are before the solution; b may ask for more.
void keepRates(const Island& island, const CommonTurns& turns, const RowValues& b,
               RowValues& rates) {
  rates = b;
  forEachBody(island, [&](const Body& body, std::size_t k, int first) {
    evaluateRates(body, turns.turn[k], rates.segment(first, body.constraints.own_rows));
  });
}

/// Those that a solution pressed together; of an impact, as between them nothing bounces.
void keepPressed(const Island& island, int first_pair, const RowValues& p,
                 std::vector<BodyPair>& pressed) {
  const std::vector<Contact>& touching = island.pairs.touching.contacts;
  for (std::size_t i = 0; i < touching.size(); ++i)
    if (p[first_pair + 3 * static_cast<int>(i)] > 0)
      pressed.push_back({touching[i].ragdoll, touching[i].other, false});
}

/// Which velocities a solution is for.
struct Solution {
  double h = 0;          ///< [s] of the motion before it
  bool impact = false;   ///< after an impact,
  bool bounces = false;  ///< in which what is fast enough bounces
};

/// b <- the rates of all rows; returns how the bodies turn together, until the next call.
const CommonTurns& evaluateAllRates(Island& island, int first_pair, const Solution& of,
                                    RowValues& b) {
  JointSchur& joint = island.s.joint;
  b.resize(joint.size());
  const CommonTurns& turns =
      findTurns(island, TurnOf::kVelocity, of.impact ? Held::kAfterImpact : Held::kBeforeImpact);
  forEachBody(island, [&](Body& body, std::size_t k, int first) {
    auto own = b.segment(first, body.constraints.own_rows);
    evaluateRates(body, turns.turn[k], own);
    if (of.impact) evaluateImpact(body, of.bounces, own);
  });
  const StepContext& step = island.context;
  const TouchingContacts& between = island.pairs.touching;
  const auto turnOf = [&](const Contact& c) { return commonTurn(island, turns, c); };
  evaluateContactRates(step, between, joint, first_pair, turnOf, b);
  if (of.impact) evaluateContactImpacts(step, between, joint, first_pair, of.bounces, b);
  return turns;
}

/// p <- what the rows pressed with.
void startWarm(const Island& island, int first_pair, RowValues& p) {
  forEachBody(island, [&](const Body& body, std::size_t, int first) {
    const int rows = body.constraints.own_rows;
    p.segment(first, rows) = Eigen::Map<const Eigen::VectorXd>(body.touching.warm.data(), rows);
  });
  std::copy(island.pairs.touching.warm.begin(), island.pairs.touching.warm.end(),
            p.data() + first_pair);
}

/// The bodies' velocities <- with impulses p; returns each one's part of them, until the next call.
const std::vector<RowValues>& push(Island& island, const RowValues& p) {
  IslandScratch& s = island.s;
  s.joint.split(p, s.parts);
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    Schur& schur = island.bodies[k]->memory->schur;
    if (!schur.empty()) schur.move(s.parts[k], island.bodies[k]->vData());
  }
  return s.parts;
}

/// Damps velocities in which what pressed, p, has acted already: at the motion's start its impulses
/// act after the damping, and the two halves mirror each other. So has what turns bodies together,
/// which is in no row's answer. b <- the rates then, but for those impulses.
void pressAndDamp(Island& island, int first_pair, double damping, const RowValues& p,
                  RowValues& b) {
  const std::vector<RowValues>* parts = p.isZero(0) ? nullptr : &push(island, p);
  dampWithin(island, damping);
  evaluateAllRates(island, first_pair, {}, b);
  if (parts) island.s.joint.addAnswer(-1, *parts, b);
}

/// One solution of the rates and what it does to velocities. damping: [s] of the motion within.
const RowValues& pushVelocities(Island& island, int first_pair, const Solution& of,
                                double damping = 0) {
  IslandScratch& s = island.s;
  RowValues &b = s.b, &p = s.p, &change = s.change;
  const bool damps = damping != 0 && island.context.model.solver.joint_damping > 0;
  bool pressed = damps;
  p.setZero(s.joint.size());
  if (!of.impact) startWarm(island, first_pair, p);
  if (!damps || isLogged(island)) {
    const CommonTurns& turns = evaluateAllRates(island, first_pair, of, b);
    if (isLogged(island)) keepRates(island, turns, b, s.rates);
    pressed = pressed || (!of.impact && turns.any());
  }
  if (pressed) {
    change = p;
    pressAndDamp(island, first_pair, damps ? damping : 0, change, b);
  }
  const Sweeps kind = of.impact ? Sweeps::kOfAnImpact : Sweeps::kAlongTheSlip;
  const bool settled = s.joint.solve(b, p, sweepsOf(island, kind));
  if (of.impact && !settled && solveExactly(island, b, p)) s.joint.holdInCones(p);
  keepPressed(island, first_pair, p, island.pairs.pushed);
  if (pressed) change = p - change;
  push(island, pressed ? change : p);
  if (isLogged(island)) logVelocities(island, p, s.rates, {of.impact, of.h});
  if (!damps) dampWithin(island, damping);
  return p;
}

/// One solution of an impact.
void solveImpact(Island& island, int first_pair, const Solution& of, VelocitySolution& solution) {
  std::vector<double>& before = island.s.energies;
  before.clear();
  for (Body* body : island.bodies) before.push_back(kineticEnergy(*body));
  const RowValues& impulses = pushVelocities(island, first_pair, of);
  keepPressed(island, first_pair, impulses, island.pairs.met);
  solution.impulses = &impulses;
  solution.energies = &before;
}

bool touches(const Island& island) {
  return !island.pairs.touching.contacts.empty() ||
         std::any_of(island.bodies.begin(), island.bodies.end(), [](const Body* body) {
           return !body->touching.contacts.empty() || !body->touching.limits.empty();
         });
}

}  // namespace

void findTouching(Body& body, double h, bool leapfrog) {
  body.touching.clear();
  keepTouching(body, *body.context, body.constraints, body.total, h, leapfrog, body.touching);
  keepTouchingLimits(body, h, leapfrog);
}

double leapfrogDefect(const Island& island, double h) {
  double most = 0;
  for (const Body* body : island.bodies)
    for (int k = 0; k < body->n; ++k)
      most = std::max(most,
                      (body->motion.dx.col(k) - 0.5 * h * (body->saved.v.col(k) + body->v().col(k)))
                          .squaredNorm());
  return std::sqrt(most);
}

VelocitySolution finishMotion(Island& island, double h, bool leapfrog, Stage stage,
                              double damping) {
  findTouchingPairs(island, h, leapfrog);
  if (isLogged(island)) logPositions(island, h, leapfrog);
  for (Body* body : island.bodies) makeMotion(*body, h, leapfrog);
  const VelocitySolution solution = solveVelocities(island, stage, h, damping);
  for (Body* body : island.bodies) body->memory->response.endIsStart();
  return solution;
}

VelocitySolution bounce(Island& island, Stage stage) {
  for (Body* body : island.bodies) {
    body->motion.dx.setZero(3, body->n);
    body->memory->response.setStart(body->xData());
    findTouching(*body, 0);
  }
  findTouchingPairs(island, 0, true);
  return solveVelocities(island, stage, 0, 0);
}

VelocitySolution solveVelocities(Island& island, Stage stage, double h, double damping) {
  const bool moves = stage == Stage::kMotion || stage == Stage::kImpact;
  const bool measured = moves && island.context.isPart();
  VelocitySolution solution;
  JointSchur& joint = island.s.joint;
  joint.clear(island.opensOverlaps());
  if (!touches(island)) {
    dampWithin(island, damping);
    if (measured) solution.defect = leapfrogDefect(island, h);
    return solution;
  }
  for (Body* body : island.bodies) {
    buildTouchingRows(*body);
    joint.addBody(body->memory->schur);
  }
  const int first_pair = joint.size();
  for (std::size_t i = 0; i < island.pairs.touching.contacts.size(); ++i)
    addTouchingPair(island, static_cast<int>(i));
  for (Body* body : island.bodies) {
    BodyMemory& memory = *body->memory;
    if (!memory.schur.empty()) memory.response.assemble(memory.schur, moves);
  }
  if (moves) {
    // What pressed all the while does so until the impact, which is not to take that back.
    if (stage == Stage::kImpact)
      lockHit(island, first_pair);
    else if (h > 0)
      lockComing(island, first_pair);
    solution.impulses = &pushVelocities(island, first_pair, {h}, damping);
    if (measured) solution.defect = leapfrogDefect(island, h);
    if (stage == Stage::kMotion) return solution;
    if (pressesItself(island)) restoreAngularMomentum(island, h, Held::kBeforeImpact);
    keepPressed(island, first_pair, *solution.impulses, island.pairs.met);
  }
  solveImpact(island, first_pair, {h, true, stage != Stage::kStop}, solution);
  return solution;
}

}  // namespace ragdoll
