#include "core/direct/energy.h"

#include <algorithm>
#include <cmath>

#include "core/contact/detect.h"
#include "core/direct/constants.h"
#include "core/direct/moving_obstacles.h"
#include "core/direct/workspace.h"
#include "core/mechanics/energy_removal.h"

namespace ragdoll {
namespace {

/// [J] in the springs of a body's contacts, with obstacles and itself, at a pose (3 x N), before or
/// after the motion over `took` [s]: a motion itself knows those that it was solved with, and by
/// planes.
double storedAt(Body& body, double took, const Points& pose, bool after) {
  const StepContext& step = *body.context;
  std::vector<Contact>& contacts = body.constraints.scratch;
  contacts.clear();
  appendContacts(step.model, obstaclesOver(body, took), pose, pose, body.index, 0, contacts);
  if (step.model.self_collision)
    body.detector.appendSelf(step.model, pose, pose, body.index, PairSearch::touches(0), contacts);
  double stored = 0;
  for (const Contact& c : contacts) stored += c.storedEnergy(after ? c.gapAt(pose) : c.gap_start);
  return stored;
}

/// [J] in them at the motion's start.
double storedBefore(Body& body, double took) {
  Points& before = posesOf(*body.context);
  before.middleCols(body.first, body.n) = body.saved.x;
  return storedAt(body, took, before, false);
}

/// [J] that springs of contacts gave to the motion.
double releasedByContacts(Body& body, double took) {
  const StepContext& step = *body.context;
  if (!step.model.compliant || step.relaxed) return 0;
  const double stored = storedAt(body, took, step.state.x, true);
  return storedBefore(body, took) - stored;
}

/// [J] that these and soft limits gave to the motion: less than at its start is stored in them.
double releasedEnergy(Body& body, double took) {
  double released = releasedByContacts(body, took);
  for (const LimitRow& limit : body.constraints.limits) {
    if (!limit.isSoft()) continue;
    const double value = std::min(0.0, anglesBefore(body)[limit.limit]);
    released += (limit.start * limit.start - value * value) / (2 * limit.compliance);
  }
  return released;
}

bool has(const std::vector<Body*>& bodies, int ragdoll) {
  return std::any_of(bodies.begin(), bodies.end(),
                     [ragdoll](const Body* body) { return body->index == ragdoll; });
}

/// [J] in the springs that these bodies are at an end of, at a pose.
double storedBetween(Island& island, const std::vector<Body*>& bodies, const Points& pose) {
  const StepContext& step = island.context;
  std::vector<Contact>& contacts = island.pairs.scratch;
  contacts.clear();
  island.s.detector.appendBetween(step.model, step.state, island.s.all, pose, pose,
                                  PairSearch::touches(0), contacts);
  double stored = 0;
  for (const Contact& c : contacts)
    if (has(bodies, c.ragdoll) || has(bodies, c.other)) stored += c.storedEnergy(c.gap_start);
  return stored;
}

/// [J] in them at the motion's start.
double storedBetweenBefore(Island& island, const std::vector<Body*>& bodies) {
  const StepContext& step = island.context;
  Points& before = posesOf(step);
  placeSleepers(island, before);
  for (const Body* body : island.bodies) before.middleCols(body->first, body->n) = body->saved.x;
  return storedBetween(island, bodies, before);
}

/// [J] that these gave to the motion.
double releasedByPairs(Island& island, const std::vector<Body*>& bodies) {
  const StepContext& step = island.context;
  if (island.isLone() || !step.model.compliant || step.relaxed) return 0;
  const double stored = storedBetweenBefore(island, bodies);
  return stored - storedBetween(island, bodies, step.state.x);
}

bool isSmooth(const Body& body) {
  const auto presses = [&body](const LimitRow& limit) {
    return !limit.isSoft() &&
           std::abs(limit.before) < body.context->tolerances.touching_angle;
  };
  const auto touches = [&body](const CachedImpulse& impulse) {
    return std::any_of(body.touching.limits.begin(), body.touching.limits.end(),
                       [&](const LimitRow& limit) { return impulse.a == -1 - limit.limit; });
  };
  const std::vector<CachedImpulse>& impulses = body.cache.impulses();
  return body.located == body.saved.located && body.touching.contacts.empty() &&
         std::all_of(body.touching.limits.begin(), body.touching.limits.end(), presses) &&
         std::all_of(impulses.begin(), impulses.end(), touches);
}

/// [J]
double kineticEnergyOf(Island& island) {
  double energy = 0;
  for (Body* body : island.bodies) energy += kineticEnergy(*body);
  return energy;
}

/// [N]
double weightOf(const Body& body) {
  return body.rows->mass.sum() * body.context->model.gravity.norm();
}

/// [N] of gravity and pokes, whatever their directions.
double forceOn(const Body& body) {
  const StepContext& step = *body.context;
  double force = weightOf(body);
  if (step.force) force += step.force->middleCols(body.first, body.n).colwise().norm().sum();
  return force;
}

/// [J] before the motion. Of what all but stands it may round to less than nothing.
double kineticEnergyBefore(Body& body) {
  return std::max(0.0, kineticEnergy(*body.rows, body.saved.v, body.energy));
}

/// [J] at the most, by what drives the body at `drive` [m/s]. Seen from there it gains nothing;
/// here it may be faster by twice the speed, and be lifted against what else acts on it.
double drivenWork(Body& body, double drive) {
  const double mass = body.rows->mass.sum();
  const double speed = std::sqrt(2 * kineticEnergyBefore(body) / mass);
  return drive * (2 * mass * (speed + drive) + forceOn(body) * body.context->h);
}

/// [m] How far the motion may move the body to mend what is wrong at its start: overlaps with
/// obstacles, joints beyond their limits. For sticks off their lengths: the body's size.
double mendingOf(const Body& body) {
  if (!body.isWhole()) return body.rows->scale;
  double mending = body.constraints.overlap;
  for (const LimitRow& limit : body.constraints.limits)
    if (!limit.isSoft()) mending = std::max(mending, -limit.before * body.rows->scale);
  return mending;
}

/// [m] The same for overlaps between bodies.
double mendingOfPairs(const Island& island) {
  double mending = 0;
  for (const Contact& c : island.pairs.contacts)
    if (!c.isSoft()) mending = std::max(mending, -c.gap_start);
  return mending;
}

/// [J] at the most, by which the bodies are lifted: by what is mended and by what drives them, at
/// the speed that no overlap opens at, and by what a solution may leave.
double liftingWork(const Island& island, double took) {
  const double pairs = mendingOfPairs(island), drive = driveSpeed(island);
  double work = 0;
  for (const Body* body : island.bodies) {
    const double moved = std::max(pairs, mendingOf(*body)) + drive * took;
    const double lift = std::min(kWildSpeed / kRecoverySpeed * moved, kWildSpeed * took);
    work += weightOf(*body) * lift + forceOn(*body) * kTouching;
  }
  return work;
}

/// Whether an obstacle has pressed the body in its motion; before an impact: not one that it
/// reached with its end, which may have taken what rounding left.
bool hasPressed(const Body& body, Held when) {
  const std::vector<CachedImpulse>& impulses = body.cache.impulses();
  if (when == Held::kAfterImpact)
    return std::any_of(impulses.begin(), impulses.end(),
                       [](const CachedImpulse& c) { return c.obstacle >= 0; });
  const ConstraintSet& set = body.constraints;
  for (std::size_t i = 0; i < set.contacts.size() && i < set.row.size(); ++i) {
    const int row = set.row[i];
    if (set.contacts[i].obstacle >= 0 && row >= 0 && row < body.total.size() &&
        body.total[row] > 0 && !isReached(set.role[i]))
      return true;
  }
  return false;
}

/// Whether an obstacle touches the body or presses it. One that it leaves has pushed it in an
/// impact, maybe.
bool meetsObstacle(const Body& body, Held when) {
  const TouchingSet& touching = body.touching;
  for (std::size_t i = 0; i < touching.contacts.size(); ++i)
    if (touching.contacts[i].obstacle >= 0 && (when == Held::kAfterImpact || !touching.hit[i]))
      return true;
  return hasPressed(body, when);
}

}  // namespace

bool isHeld(const Island& island, const std::vector<Body*>& bodies, Held when) {
  for (const Body* body : bodies)
    if (!body->pinned->pins.empty() || meetsObstacle(*body, when)) return true;
  const auto isSleeper = [&island](int ragdoll) { return island.placeOf(ragdoll) < 0; };
  const auto holds = [&](const BodyPair& pair) {
    return (isSleeper(pair.first) && has(bodies, pair.second)) ||
           (isSleeper(pair.second) && has(bodies, pair.first));
  };
  return std::any_of(island.pairs.pushed.begin(), island.pairs.pushed.end(), holds);
}

double kineticEnergy(Body& body) { return kineticEnergy(*body.rows, body.v(), body.energy); }

double swingScale(Island& island) {
  double scale = kineticEnergyOf(island);
  for (const Body* body : island.bodies) scale += weightOf(*body) * body->rows->scale;
  return scale;
}

double driveSpeed(const Island& island) {
  double speed = 0;
  for (const Body* body : island.bodies) {
    if (!body->driven) continue;
    speed = std::max(speed, body->pin_speed);
    for (const Contact& c : body->constraints.contacts)
      speed = std::max(speed, c.surface_motion.norm() / body->context->h);
  }
  return speed;
}

double gainedEnergy(Body& body, double took, double drive) {
  const StepContext& step = *body.context;
  const StickRows& rows = *body.rows;
  Points& moved = body.moved;
  moved = body.x() - body.saved.x;
  double gain = energyGain(rows, body.saved.v, body.v(), moved, step.model.gravity, body.energy);
  gain -= body.given + std::min(0.0, body.damped);
  if (step.force && !body.pushed)
    gain -= step.force->middleCols(body.first, body.n).cwiseProduct(moved).sum();
  gain -= releasedEnergy(body, took);
  return drive > 0 ? gain - drivenWork(body, drive) : gain;
}

bool isSmooth(Island& island) {
  return island.pairs.cache.empty() && island.pairs.touching.contacts.empty() &&
         std::all_of(island.bodies.begin(), island.bodies.end(),
                     [](const Body* body) { return body->pin_speed == 0 && isSmooth(*body); }) &&
         releasedByPairs(island, island.bodies) == 0;
}

double gainedEnergy(Island& island, const std::vector<Body*>& bodies, double took, double drive) {
  double gain = 0;
  for (Body* body : bodies) gain += gainedEnergy(*body, took, drive);
  return gain - releasedByPairs(island, bodies);
}

double gainedEnergy(Island& island, double took, double drive) {
  return gainedEnergy(island, island.bodies, took, drive);
}

bool isLargeGain(Island& island, double gain, bool smooth) {
  if (smooth ? gain == 0 : gain <= kRedoGain) return false;
  const double energy = smooth ? swingScale(island) : kineticEnergyOf(island);
  return smooth ? std::abs(gain) > kRedoGain * energy : gain > kRedoGain * energy;
}

double wildGain(Island& island) {
  double wild = 0;
  for (Body* body : island.bodies)
    wild += kineticEnergyBefore(*body) + 0.5 * body->rows->mass.sum() * kWildSpeed * kWildSpeed;
  return wild;
}

double takeEnergyOut(Island& island, const std::vector<Body*>& bodies, bool held, double gain) {
  std::vector<int>& ragdolls = island.s.drained;
  ragdolls.clear();
  for (const Body* body : bodies) ragdolls.push_back(body->index);
  return takeEnergyOut(island.context.model, ragdolls, held, gain, island.context.state.x,
                       island.context.state.v, island.s.removal);
}

bool removeEnergy(Island& island, double gain, double took) {
  if (!(gain > 0)) return true;
  const bool held = isHeld(island, island.bodies);
  const double left = takeEnergyOut(island, island.bodies, held, gain);
  const double moves = kineticEnergyOf(island);
  // What all but rests on springs has no motion that it could be taken out of in the next step.
  const bool springs = island.context.model.compliant && !island.context.relaxed;
  if (springs && moves < kRedoGain && left > kRedoGain * moves + kLeastGain) return false;
  double energy = std::max(1.0, moves);  // without what was gained
  if (left <= kRedoGain * energy) return true;
  for (Body* body : island.bodies) energy += kineticEnergyBefore(*body);
  if (island.context.model.compliant) {  // springs may have held it all
    for (Body* body : island.bodies) energy += storedBefore(*body, took);
    if (!island.isLone()) energy += storedBetweenBefore(island, island.bodies);
  }
  return left <= kRedoGain * energy + liftingWork(island, took);
}

}  // namespace ragdoll
