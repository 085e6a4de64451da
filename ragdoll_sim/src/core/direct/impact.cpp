#include "core/direct/impact.h"

#include <algorithm>
#include <cmath>

#include "core/direct/candidates.h"
#include "core/direct/constants.h"

namespace ragdoll {
namespace {

/// [m/s] at which the gap opens at the motion's start.
double rateOf(const Body& body, const Contact& contact) {
  return openingRate(body, contact.touches_at_start ? contact.atStart() : contact);
}

/// [rad/s] the same of a limit.
double rateOf(const Body& body, const LimitRow& limit) {
  const LimitRow& row = anglesBefore(body).row(limit.limit);
  const Points& v = body.context->state.v;
  double rate = 0;
  for (int k = 0; k < row.count; ++k) rate += row.gradient[k].dot(v.col(row.particle[k]));
  return rate;
}

/// A spring floor is reached, too, but does not bounce: the next substep begins with its spring.
bool isComingSoftly(const Body& body, const Contact& c, double h) {
  if (body.located >= kMaxLocated || c.before < body.tolerances.touching) return false;
  return (c.before - gapAfter(body, c)) / h > comingSpeed(*body.context, c);
}

bool isComing(const Body& body, const Contact& c, double h) {
  if (c.isSoft()) return isComingSoftly(body, c, h);
  if (c.gap_start < -body.tolerances.contact) return false;
  const double end = gapAfter(body, c);
  if (end < -kDeepImpact * body.rows->scale) return body.located < kMaxDeepImpacts;
  if (body.located >= kMaxLocated) return false;
  const double rate = c.before < body.tolerances.touching ? rateOf(body, c) : (end - c.before) / h;
  return -rate > comingSpeed(*body.context, c);
}

bool isComing(const Body& body, const LimitRow& limit, double h) {
  if (limit.compliance > 0 || body.located >= kMaxLocated) return false;
  if (limit.before < -body.tolerances.touching_angle) return false;
  const double rate = limit.before < body.tolerances.touching_angle
                          ? rateOf(body, limit)
                          : (limit.value - limit.before) / h;
  const double pull = std::max(kLeastPull, body.context->model.gravity.norm());
  return -rate > kRestSteps * body.context->h * pull / kLimb;
}

/// [m/s] the same of two bodies.
double rateOf(const Island& island, const Contact& pair) {
  return pairRate(island.context.state, pair.touches_at_start ? pair.atStart() : pair);
}

/// What decides for pairs, of the island's bodies: the smallest size, and how many impacts of the
/// step were located.
struct IslandImpacts {
  double scale = 1;
  int located = 0;
};

IslandImpacts impactsOf(const Island& island) {
  IslandImpacts impacts;
  for (const Body* body : island.bodies) {
    impacts.scale = std::min(impacts.scale, body->rows->scale);
    impacts.located = std::max(impacts.located, body->located);
  }
  return impacts;
}

bool isComing(const Island& island, const IslandImpacts& impacts, const Contact& pair, double h) {
  const Body& any = *island.bodies[0];
  const auto [scale, located] = impacts;
  const double end = pairGapAfter(island, pair);
  const bool touches = pair.before < any.tolerances.touching;
  const double speed = touches ? -rateOf(island, pair) : (pair.before - end) / h;
  const bool comes = located < kMaxLocated && speed > comingSpeed(island.context, pair);
  if (pair.isSoft()) return comes && !touches;
  if (pair.gap_start < -any.tolerances.contact) return false;
  return end < -kDeepImpact * scale ? located < kMaxDeepImpacts : comes;
}

bool reachesComing(const Body& body) {
  const ConstraintSet& set = body.constraints;
  for (std::size_t i = 0; i < set.contacts.size(); ++i)
    if (set.contact_role[i] == Role::kComing &&
        gapAfter(body, set.contacts[i]) < -body.tolerances.contact)
      return true;
  if (set.limits.empty()) return false;
  LimitAngles::Pose& angles = anglesAfter(body);
  for (std::size_t i = 0; i < set.limits.size(); ++i)
    if (set.limit_role[i] == Role::kComing && angles[set.limits[i].limit] < 0) return true;
  return false;
}

/// Keeps the earlier of the two.
void consider(double time, Role& role, double h, Impact& first) {
  if (time < first.time) first = {std::clamp(time, 0.0, h), &role};
}

Impact firstImpact(Body& body, double h) {
  ConstraintSet& set = body.constraints;
  Impact first{2 * h, nullptr};
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const Contact& c = set.contacts[i];
    if (set.contact_role[i] != Role::kComing) continue;
    const double end = gapAfter(body, c);
    if (end < -body.tolerances.contact)
      consider(timeOfZero(c.before, rateOf(body, c), end, h), set.contact_role[i], h, first);
  }
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    if (set.limit_role[i] != Role::kComing) continue;
    const LimitRow& limit = set.limits[i];
    const double end = anglesAfter(body)[limit.limit];
    if (end < 0)
      consider(timeOfZero(limit.before, rateOf(body, limit), end, h), set.limit_role[i], h, first);
  }
  return first;
}

/// Two bodies that come to touch each other.
Impact firstPair(Island& island, double h) {
  const double closed = -island.bodies[0]->tolerances.contact;
  PairSet& pairs = island.pairs;
  Impact first{2 * h, nullptr};
  for (std::size_t i = 0; i < pairs.contacts.size(); ++i) {
    const Contact& c = pairs.contacts[i];
    if (pairs.role[i] != Role::kComing) continue;
    const double end = pairGapAfter(island, c);
    if (end < closed)
      consider(timeOfZero(c.before, rateOf(island, c), end, h), pairs.role[i], h, first);
  }
  return first;
}

}  // namespace

double bounceSpeed(const StepContext& step, const Contact& c) {
  return kRestSteps * step.h * std::abs(c.normal.dot(step.model.gravity));
}

double comingSpeed(const StepContext& step, const Contact& c) {
  return std::max(kRestSteps * step.h * kLeastPull, bounceSpeed(step, c));
}

double timeOfZero(double start, double rate, double end, double h) {
  if (start <= 0) return 0;
  const double q = (end - start - rate * h) / (h * h);
  const double root = std::sqrt(std::max(0.0, rate * rate - 4 * q * start));
  return 2 * start / (root - rate);
}

void findComing(Body& body, double h) {
  ConstraintSet& set = body.constraints;
  if (set.overlap > kClose) return;
  for (std::size_t i = 0; i < set.contacts.size(); ++i)
    if (isComing(body, set.contacts[i], h)) set.contact_role[i] = Role::kComing;
  for (std::size_t i = 0; i < set.limits.size(); ++i)
    if (isComing(body, set.limits[i], h)) set.limit_role[i] = Role::kComing;
}

void findComing(Island& island, double h) {
  for (Body* body : island.bodies) findComing(*body, h);
  PairSet& pairs = island.pairs;
  const IslandImpacts impacts = impactsOf(island);
  for (std::size_t i = 0; i < pairs.contacts.size(); ++i)
    if (isComing(island, impacts, pairs.contacts[i], h)) pairs.role[i] = Role::kComing;
}

bool reachesComing(const Island& island) {
  const PairSet& pairs = island.pairs;
  for (std::size_t i = 0; i < pairs.contacts.size(); ++i)
    if (pairs.role[i] == Role::kComing &&
        pairGapAfter(island, pairs.contacts[i]) < -island.bodies[0]->tolerances.contact)
      return true;
  return std::any_of(island.bodies.begin(), island.bodies.end(),
                     [](const Body* body) { return reachesComing(*body); });
}

Impact firstImpact(Island& island, double h) {
  Impact first = firstPair(island, h);
  for (Body* body : island.bodies) {
    const Impact own = firstImpact(*body, h);
    if (own.time < first.time) first = own;
  }
  if (!first.role) return first;
  if (first.time < kSnap * h) first.time = 0;
  if (first.time > (1 - kSnap) * h) first.time = h;
  return first;
}

void takeImpact(Island& island, const Impact& impact) {
  *impact.role = Role::kHit;
  const auto wait = [](std::vector<Role>& roles, Role as) {
    std::replace(roles.begin(), roles.end(), Role::kComing, as);
  };
  wait(island.pairs.role, Role::kBeyond);
  for (Body* body : island.bodies) {
    wait(body->constraints.contact_role, Role::kBeyond);
    wait(body->constraints.limit_role, Role::kIfNear);
    ++body->located;
  }
}

bool touchesOther(const Body& body) {
  const ConstraintSet& set = body.constraints;
  for (std::size_t i = 0; i < set.contacts.size(); ++i)
    if (set.contact_role[i] != Role::kComing &&
        (set.contacts[i].before <= body.tolerances.touching ||
         gapAfter(body, set.contacts[i]) <= body.tolerances.touching))
      return true;
  for (std::size_t i = 0; i < set.limits.size(); ++i)
    if (set.limit_role[i] != Role::kComing &&
        (set.limits[i].value <= 0 || set.limits[i].start != 0))
      return true;
  return false;
}

double impactAgain(const Body& body, double h) {
  const ConstraintSet& set = body.constraints;
  for (std::size_t i = 0; i < set.contacts.size(); ++i)
    if (set.contact_role[i] == Role::kHit) {
      const Contact& c = set.contacts[i];
      return timeOfZero(c.before, rateOf(body, c), gapAfter(body, c), h);
    }
  for (std::size_t i = 0; i < set.limits.size(); ++i)
    if (set.limit_role[i] == Role::kHit) {
      const LimitRow& limit = set.limits[i];
      return timeOfZero(limit.before, rateOf(body, limit), anglesAfter(body)[limit.limit], h);
    }
  return h;
}

}  // namespace ragdoll
