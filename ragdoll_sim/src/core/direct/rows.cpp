#include "core/direct/rows.h"

#include <algorithm>
#include <cmath>

#include "core/direct/angular_momentum.h"
#include "core/direct/constants.h"
#include "core/direct/contact_motion.h"

namespace ragdoll {
namespace {

using Kind = Schur::Row::Kind;

// Contacts of a body with obstacles and itself, and between bodies, by one path. owner: as in
// contact_motion.h; rows: where theirs are, a body's complement or the joint ones.

/// add(contact, its place, whether it is reached just now): its rows; returns the first.
template <class Owner, class Add>
void addContactRows(const Owner& owner, ContactSet& set, const ImpulseCache& cache,
                    const Add& add) {
  set.springs.assign(set.contacts.size(), {});
  set.row.assign(set.contacts.size(), -1);
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const Contact& c = set.contacts[i];
    if (set.role[i] == Role::kComing) continue;
    if (isOnlyNear(set.role[i]) && gapAfter(owner, c) > kClose && !cache.find(c)) continue;
    set.row[i] = add(c, static_cast<int>(i), isReached(set.role[i]));
  }
}

/// turnOf(contact): that of both its sides.
template <class Owner, class Rows, class TurnOfSides>
void evaluateContactGaps(const Owner& owner, const ContactSet& set, const Rows& rows,
                         const RowValues& total, double share, const TurnOfSides& turnOf,
                         Eigen::Ref<Eigen::VectorXd> b) {
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const int row = set.row[i];
    if (row < 0) continue;
    const Contact& c = set.contacts[i];
    b[row] = gapAfter(owner, c);
    if (c.isSoft()) b[row] += set.springs[i].offset + rows.row(row).compliance * total[row];
    if (!(c.friction > 0)) continue;
    const Vec3 slip = c.slipOf(slipAfter(owner, c, turnOf(c)) - share * c.surfaceMean());
    for (int k = 1; k < 3; ++k) b[row + k] = rows.row(row + k).direction.dot(slip);
  }
}

/// springs <- those of what gives way, contacts or limits. giveOf(one of all): its Compliance.
template <class All, class Rows, class GiveOf>
bool softenRows(const All& all, const Roomy<int>& row_of, Rows& rows, double h, bool leapfrog,
                const GiveOf& giveOf, Roomy<SpringRow>& springs) {
  bool any = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const int row = row_of[i];
    if (row < 0 || !all[i].isSoft()) continue;
    const double answer = rows.entry(row, row) - rows.row(row).compliance;
    springs[i] = springRow(giveOf(all[i]), all[i].before, h, answer, leapfrog);
    rows.soften(row, springs[i].compliance);
    any = true;
  }
  return any;
}

template <class Rows>
bool softenContacts(ContactSet& set, Rows& rows, double h, bool leapfrog) {
  const auto giveOf = [](const Contact& c) { return c.give; };
  return softenRows(set.contacts, set.row, rows, h, leapfrog, giveOf, set.springs);
}

bool softenLimits(ConstraintSet& set, Schur& schur, double h, bool leapfrog) {
  const auto giveOf = [](const LimitRow& limit) { return limit.give(); };
  return softenRows(set.limits, set.limit_row, schur, h, leapfrog, giveOf, set.limit_springs);
}

/// By how much a row is off: violated, and, closed, open while it presses. Left open it might not
/// count as touching where velocities are solved for, which would lack its half step of force.
double residual(double slack, double p, bool closed) {
  return closed && p > 0 ? std::abs(slack) : -slack;
}

template <class Owner>
double worstOfContacts(const Owner& owner, const ContactSet& set, const RowValues& total,
                       bool closed) {
  double worst = 0;
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    if (set.row[i] < 0) continue;
    const double p = total[set.row[i]], gap = gapAfter(owner, set.contacts[i]);
    worst = std::max(worst, residual(set.springs[i].slack(gap, p), p, closed));
  }
  return worst;
}

/// What lies along something has two contacts with it, of the same parts.
template <class Rows>
void warmStartContacts(const ContactSet& set, const Rows& rows, double h, ImpulseCache& cache,
                       Eigen::Ref<Eigen::VectorXd> p) {
  cache.startHandingOut();
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const int row = set.row[i];
    const CachedImpulse* was = row < 0 ? nullptr : cache.handOut(set.contacts[i]);
    if (!was) continue;
    for (int k = row; k < row + rowsOf(rows.row(row)); ++k)
      p[k] = was->impulse.dot(rows.row(k).direction) * h * h;
    p[row] = std::max(0.0, p[row]);
  }
}

/// keep(contact, whether its friction holds it), of those that press.
template <class Rows, class Keep>
void rememberContacts(const ContactSet& set, const Rows& rows, const RowValues& total, double h,
                      ImpulseCache& cache, const Keep& keep) {
  cache.clear();
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const int row = set.row[i];
    if (row < 0 || !(total[row] > 0)) continue;
    const Contact& c = set.contacts[i];
    cache.add(keyOf(c));
    for (int k = row; k < row + rowsOf(c); ++k)
      cache.last().impulse += total[k] / (h * h) * rows.row(k).direction;
    keep(c, c.friction > 0 &&
                isInsideCone(c.friction, total[row], std::hypot(total[row + 1], total[row + 2])));
  }
}

/// Whether a limit presses at the start of a motion: there it pushes along its direction there, as
/// the sticks do.
bool pressesAtStart(const LimitRow& limit, double touching) {
  return limit.isSoft() ? limit.before < 0 : std::abs(limit.before) < touching;
}

void buildLimitRows(Body& body, bool leapfrog) {
  ConstraintSet& set = body.constraints;
  Schur& schur = body.memory->schur;
  set.limit_springs.assign(set.limits.size(), {});
  set.limit_row.assign(set.limits.size(), -1);
  if (set.limits.empty()) return;
  LimitAngles::Pose& angles = anglesAfter(body);
  const double* ahead = aheadOf(body);
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    LimitRow& limit = set.limits[i];
    if (set.limit_role[i] == Role::kComing) continue;
    if (set.limit_role[i] == Role::kIfNear && !limit.isSoft() &&
        angles[limit.limit] > kClose / kLever && !body.cache.find(limit))
      continue;
    if (leapfrog && pressesAtStart(limit, body.context->tolerances.touching_angle))
      anglesBefore(body).evaluate(limit, ahead);
    else
      angles.evaluate(limit, ahead);
    set.limit_row[i] = schur.size();
    schur.addLimit(limit, static_cast<int>(i));
  }
}

}  // namespace

void buildRows(Body& body, bool leapfrog) {
  Schur& schur = body.memory->schur;
  schur.start(body.first);
  addContactRows(body, body.constraints, body.cache,
                 [&](const Contact& c, int source, bool reached) {
                   const int row = schur.size();
                   schur.addContact(leapfrog ? c.atStart() : c, source);
                   if (reached) schur.smooth(row);
                   return row;
                 });
  buildLimitRows(body, leapfrog);
  body.constraints.own_rows = schur.size();
}

void buildRows(Island& island, bool leapfrog) {
  island.s.joint.clear(island.opensOverlaps());
  for (Body* body : island.bodies) {
    buildRows(*body, leapfrog);
    island.s.joint.addBody(body->memory->schur);
  }
  addContactRows(island, island.pairs, island.pairs.cache,
                 [&](const Contact& c, int source, bool reached) {
                   return addPairRows(island, leapfrog ? c.atStart() : c, source, reached);
                 });
}

int addPairRows(Island& island, const Contact& c, int source, bool smooth) {
  JointSchur& joint = island.s.joint;
  const int first = joint.size();
  const std::array<int, 2> place{island.placeOf(c.ragdoll), island.placeOf(c.other)};
  std::array<int, 2> row{-1, -1};
  for (int side = 0; side < 2; ++side) {
    if (place[side] < 0) continue;
    Schur& schur = island.bodies[place[side]]->memory->schur;
    row[side] = schur.size();
    schur.addContact(c, source, 2 * side, 2 * side + 2);
    if (smooth) schur.smooth(row[side]);
  }
  joint.addShared(c, place[0], row[0], place[1], row[1]);
  return first;
}

void evaluateGaps(Body& body, double h, const Vec3& turn, Eigen::Ref<Eigen::VectorXd> b) {
  const ConstraintSet& set = body.constraints;
  const Schur& schur = body.memory->schur;
  const auto turnOf = [&turn](const Contact& c) { return commonTurn(turn, c); };
  evaluateContactGaps(body, set, schur, body.total, h / body.context->h, turnOf, b);
  if (set.limits.empty()) return;
  LimitAngles::Pose& angles = anglesAfter(body);
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    const int row = set.limit_row[i];
    if (row < 0) continue;
    const LimitRow& limit = set.limits[i];
    b[row] = angles[limit.limit] + limit.opening + set.limit_springs[i].offset +
             schur.row(row).compliance * body.total[row];
  }
}

const CommonTurns& evaluateGaps(Island& island, double h, RowValues& b) {
  const JointSchur& joint = island.s.joint;
  const CommonTurns& turns = findTurns(island, TurnOf::kMotion, Held::kAfterImpact);
  b.resize(joint.size());
  for (std::size_t k = 0; k < island.bodies.size(); ++k) {
    Body& body = *island.bodies[k];
    evaluateGaps(body, h, turns.turn[k],
                 b.segment(joint.firstOf(static_cast<int>(k)), body.constraints.own_rows));
  }
  const auto turnOf = [&](const Contact& c) { return commonTurn(island, turns, c); };
  evaluateContactGaps(island, island.pairs, joint, island.s.total, h / island.context.h, turnOf, b);
  return turns;
}

bool soften(Island& island, double h, bool leapfrog) {
  bool any = false;
  for (Body* body : island.bodies) {
    Schur& schur = body->memory->schur;
    if (schur.empty()) continue;
    any = softenContacts(body->constraints, schur, h, leapfrog) || any;
    any = softenLimits(body->constraints, schur, h, leapfrog) || any;
  }
  return softenContacts(island.pairs, island.s.joint, h, leapfrog) || any;
}

bool anyCloses(const Island& island, const RowValues& b) {
  const auto presses = [](const auto& spring) { return spring.isSoft() && spring.before < 0; };
  const auto any = [&](const auto& all) { return std::any_of(all.begin(), all.end(), presses); };
  if (any(island.pairs.contacts) ||
      std::any_of(island.bodies.begin(), island.bodies.end(), [&](const Body* body) {
        return any(body->constraints.contacts) || any(body->constraints.limits);
      }))
    return true;
  for (int i = 0; i < island.s.joint.size(); ++i)
    if (island.s.joint.row(i).kind != Kind::kTangent && b[i] < 0) return true;
  return false;
}

double worstResidual(Body& body, bool closed) {
  const ConstraintSet& set = body.constraints;
  double worst = worstOfContacts(body, set, body.total, closed);
  if (set.limits.empty()) return worst;
  LimitAngles::Pose& angles = anglesAfter(body);
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    const LimitRow& limit = set.limits[i];
    const int row = set.limit_row[i];
    if (row < 0) continue;
    const double p = body.total[row];
    if (limit.isSoft() || (closed && p > 0) || !angles.isBeyond(limit.limit, -limit.opening)) {
      const double slack = set.limit_springs[i].slack(angles[limit.limit] + limit.opening, p);
      worst = std::max(worst, residual(slack, p, closed) * kLever);
    }
  }
  return worst;
}

double worstResidual(Island& island, bool closed) {
  double worst = worstOfContacts(island, island.pairs, island.s.total, closed);
  for (Body* body : island.bodies) worst = std::max(worst, worstResidual(*body, closed));
  return worst;
}

void warmStart(Body& body, double h, Eigen::Ref<Eigen::VectorXd> p) {
  p.setZero();
  if (body.cache.empty()) return;
  const ConstraintSet& set = body.constraints;
  warmStartContacts(set, body.memory->schur, h, body.cache, p);
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    const int row = set.limit_row[i];
    const CachedImpulse* was = row < 0 ? nullptr : body.cache.find(set.limits[i]);
    if (was) p[row] = was->impulse.x() * h * h;
  }
}

void warmStart(Island& island, double h, RowValues& p) {
  const JointSchur& joint = island.s.joint;
  p.setZero(joint.size());
  for (std::size_t k = 0; k < island.bodies.size(); ++k)
    warmStart(
        *island.bodies[k], h,
        p.segment(joint.firstOf(static_cast<int>(k)), island.bodies[k]->constraints.own_rows));
  warmStartContacts(island.pairs, joint, h, island.pairs.cache, p);
}

void rememberImpulses(Body& body, double h) {
  const ConstraintSet& set = body.constraints;
  ImpulseCache& cache = body.cache;
  rememberContacts(set, body.memory->schur, body.total, h, cache,
                   [&](const Contact& c, bool holds) {
                     if (holds && c.obstacle >= 0) cache.setGripped();
                   });
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    const int row = set.limit_row[i];
    if (row < 0 || body.total[row] == 0) continue;
    cache.add(keyOf(set.limits[i]));
    cache.last().impulse = Vec3(body.total[row] / (h * h), 0, 0);
  }
}

void rememberImpulses(Island& island, double h) {
  for (Body* body : island.bodies) rememberImpulses(*body, h);
  PairSet& pairs = island.pairs;
  pairs.pressing.clear();
  rememberContacts(pairs, island.s.joint, island.s.total, h, pairs.cache,
                   [&pairs](const Contact& c, bool holds) {
                     pairs.pressing.push_back({c.ragdoll, c.other, holds});
                     pairs.pushed.push_back(pairs.pressing.back());
                   });
}

}  // namespace ragdoll
