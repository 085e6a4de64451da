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
  if (body.located >= kMaxLocated || c.before < body.context->tolerances.touching) return false;
  return (c.before - gapAfter(body, c)) / h > comingSpeed(*body.context, c);
}

bool isComing(const Body& body, const Contact& c, double h) {
  if (c.isSoft()) return isComingSoftly(body, c, h);
  if (c.gap_start < -body.context->tolerances.contact) return false;
  const double end = gapAfter(body, c);
  if (end < -kDeepImpact * body.rows->scale) return body.located < kMaxDeepImpacts;
  if (body.located >= kMaxLocated) return false;
  const double rate =
      c.before < body.context->tolerances.touching ? rateOf(body, c) : (end - c.before) / h;
  return -rate > comingSpeed(*body.context, c);
}

bool isComing(const Body& body, const LimitRow& limit, double h) {
  if (limit.compliance > 0 || body.located >= kMaxLocated) return false;
  if (limit.before < -body.context->tolerances.touching_angle) return false;
  const double rate = limit.before < body.context->tolerances.touching_angle
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
  const bool touches = pair.before < any.context->tolerances.touching;
  const double speed = touches ? -rateOf(island, pair) : (pair.before - end) / h;
  const bool comes = located < kMaxLocated && speed > comingSpeed(island.context, pair);
  if (pair.isSoft()) return comes && !touches;
  if (pair.gap_start < -any.context->tolerances.contact) return false;
  return end < -kDeepImpact * scale ? located < kMaxDeepImpacts : comes;
}

/// Whether motions go through a contact that is coming, by more than may be left.
template <class Gap>
bool reachesComing(const ContactSet& set, const Gap& gap, double left) {
  for (std::size_t i = 0; i < set.contacts.size(); ++i)
    if (set.role[i] == Role::kComing && gap(set.contacts[i]) < -left) return true;
  return false;
}

/// The same of limits.
bool reachesLimit(const Body& body) {
  const ConstraintSet& set = body.constraints;
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

/// The first of the contacts that are coming. rate(contact): [m/s] at which it opens at the start.
template <class Gap, class Rate>
Impact firstImpact(ContactSet& set, const Gap& gap, const Rate& rate, double left, double h) {
  Impact first{2 * h, nullptr};
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const Contact& c = set.contacts[i];
    if (set.role[i] != Role::kComing) continue;
    const double end = gap(c);
    if (end < -left) consider(timeOfZero(c.before, rate(c), end, h), set.role[i], h, first);
  }
  return first;
}

Impact firstImpact(Body& body, double h) {
  ConstraintSet& set = body.constraints;
  Impact first = firstImpact(
      set, [&body](const Contact& c) { return gapAfter(body, c); },
      [&body](const Contact& c) { return rateOf(body, c); }, body.context->tolerances.contact, h);
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    if (set.limit_role[i] != Role::kComing) continue;
    const LimitRow& limit = set.limits[i];
    const double end = anglesAfter(body)[limit.limit];
    if (end < 0)
      consider(timeOfZero(limit.before, rateOf(body, limit), end, h), set.limit_role[i], h, first);
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
    if (isComing(body, set.contacts[i], h)) set.role[i] = Role::kComing;
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
  return reachesComing(
             island.pairs, [&island](const Contact& c) { return pairGapAfter(island, c); },
             island.context.tolerances.contact) ||
         std::any_of(island.bodies.begin(), island.bodies.end(), [](const Body* body) {
           return reachesComing(
                      body->constraints, [body](const Contact& c) { return gapAfter(*body, c); },
                      body->context->tolerances.contact) ||
                  reachesLimit(*body);
         });
}

Impact firstImpact(Island& island, double h) {
  Impact first = firstImpact(
      island.pairs, [&island](const Contact& c) { return pairGapAfter(island, c); },
      [&island](const Contact& c) { return rateOf(island, c); }, island.context.tolerances.contact,
      h);
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
    wait(body->constraints.role, Role::kBeyond);
    wait(body->constraints.limit_role, Role::kIfNear);
    ++body->located;
  }
}

bool touchesOther(const Body& body) {
  const ConstraintSet& set = body.constraints;
  for (std::size_t i = 0; i < set.contacts.size(); ++i)
    if (set.role[i] != Role::kComing &&
        (set.contacts[i].before <= body.context->tolerances.touching ||
         gapAfter(body, set.contacts[i]) <= body.context->tolerances.touching))
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
    if (set.role[i] == Role::kHit) {
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
