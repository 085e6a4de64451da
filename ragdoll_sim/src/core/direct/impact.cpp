#include "core/direct/impact.h"

#include <algorithm>
#include <cmath>

#include "core/contact/constants.h"
#include "core/direct/constants.h"
#include "core/direct/contact_motion.h"
#include "core/direct/contact_path.h"

namespace ragdoll {
namespace {

/// [m/s] at which the gap opens at the motion's start.
double rateAtStart(const StepContext& step, const Contact& c) {
  return openingRate(step, c.touches_at_start ? c.atStart() : c);
}

/// [rad/s] at which a limit opens at the start, by these velocities [m/s] of the columns from
/// `first` on.
double rateAtStart(const Body& body, const LimitRow& limit, const Points& v, int first) {
  const LimitRow& row = anglesBefore(body).row(limit.limit, aheadOf(body));
  double rate = 0;
  for (int k = 0; k < row.count; ++k) rate += row.gradient[k].dot(v.col(row.particle[k] - first));
  return rate;
}
double rateAtStart(const Body& body, const LimitRow& limit) {
  return rateAtStart(body, limit, body.context->state.v, 0);
}

/// The same of what touches, before the damping of the motion's first half: what that does is no
/// impact.
double rateBeforeDamping(const Body& body, const LimitRow& limit) {
  return rateAtStart(body, limit, body.saved.v, body.first);
}
template <class Owner>
double rateBeforeDamping(const Owner& owner, const StepContext& step, const Contact& c) {
  const Contact start = c.atStart();
  Vec3 rate = -start.surface_end / step.h;
  visitMoving(owner, start, [&](int k, const Body& body, int i) {
    rate += start.weight[k] * body.saved.v.col(i);
  });
  return start.normal.dot(rate);
}

/// What decides for contacts: the smallest size of the bodies, by a human's, how many impacts of
/// the step were located, and [m] the deepest overlap.
struct Located {
  double scale = 1;
  int count = 0;
  double overlap = 0;
};

Located locatedOf(const Body& body) {
  return {body.rows->scale, body.located, body.constraints.overlap};
}
Located locatedOf(const Island& island) {
  Located all;
  for (const Body* body : island.bodies) {
    all.scale = std::min(all.scale, body->rows->scale);
    all.count = std::max(all.count, body->located);
    all.overlap = std::max(all.overlap, body->constraints.overlap);
  }
  return all;
}

/// A spring is reached, too, but does not bounce: the next substep begins with it.
template <class Owner>
bool isComing(const Owner& owner, const StepContext& step, const Located& located, const Contact& c,
              double h) {
  const bool touches = c.before < step.tolerances.touching;
  if (c.isSoft() ? touches : c.gap_start < -step.tolerances.contact) return false;
  const double end = gapAfter(owner, c);
  if (!c.isSoft() && end < -kDeepImpact * located.scale) return located.count < kMaxDeepImpacts;
  if (located.count >= kMaxLocated) return false;
  const double rate = touches ? rateBeforeDamping(owner, step, c) : (end - c.before) / h;
  return -rate > comingSpeed(step, c);
}

template <class Owner>
void findComingContacts(const Owner& owner, const StepContext& step, ContactSet& set, double h) {
  const Located located = locatedOf(owner);
  for (std::size_t i = 0; i < set.contacts.size(); ++i)
    if (isComing(owner, step, located, set.contacts[i], h)) set.role[i] = Role::kComing;
}

bool isComing(const Body& body, const LimitRow& limit, double h) {
  const double touching = body.context->tolerances.touching_angle;
  const bool touches = limit.before < touching;
  if (limit.isSoft() ? touches : limit.before < -touching) return false;
  if (body.located >= kMaxLocated) return false;
  const double rate = touches ? rateBeforeDamping(body, limit) : (limit.value - limit.before) / h;
  const double pull = std::max(kLeastPull, body.context->model.gravity.norm());
  return -rate > kRestSteps * body.context->h * pull / kLimb;
}

/// Whether motions go through a contact that is coming, by more than may be left.
template <class Owner>
bool reachesContact(const Owner& owner, const StepContext& step, const ContactSet& set) {
  for (std::size_t i = 0; i < set.contacts.size(); ++i)
    if (set.role[i] == Role::kComing && gapAfter(owner, set.contacts[i]) < -step.tolerances.contact)
      return true;
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

/// [s] When a contact, or a limit, is reached by a motion over h that ends beyond it, at `end`.
double timeOfTouch(const StepContext& step, const Contact& c, double end, double h) {
  return timeOfZero(c.before, rateAtStart(step, c), end, h);
}
double timeOfTouch(const Body& body, const LimitRow& limit, double end, double h) {
  return timeOfZero(limit.before, rateAtStart(body, limit), end, h);
}

/// A motion that should end where something is hit: gaps [m], [rad] at its start and end, and the
/// rate at which it opens at the start.
struct Arrival {
  bool found = false;
  double before = 0, rate = 0, end = 0, touching = 0;

  double time(double h) const { return timeOfZero(before, rate, end, h); }
};

/// What it hits has pushed the motion back to where it is: the gap without that.
template <class Rows>
void takeBack(const Rows& rows, const RowValues& total, int row, Arrival& arrival) {
  if (row >= 0 && row < total.size() && total[row] > 0)
    arrival.end -= rows.entry(row, row) * total[row];
}

/// At a contact; i: its place in the set.
template <class Owner>
Arrival arrivalAt(const Owner& owner, const StepContext& step, const ContactSet& set, int& i) {
  const auto hit = std::find(set.role.begin(), set.role.end(), Role::kHit);
  if (hit == set.role.end()) return {};
  i = static_cast<int>(hit - set.role.begin());
  const Contact& c = set.contacts[i];
  return {true, c.before, rateAtStart(step, c), gapAfter(owner, c), step.tolerances.touching};
}

/// At a contact of the body's own, or a limit. pushed: whether that has a row.
Arrival arrivalOf(const Body& body, bool pushed) {
  const StepContext& step = *body.context;
  const ConstraintSet& set = body.constraints;
  Arrival arrival;
  int i = 0, row = -1;
  const auto hit = std::find(set.limit_role.begin(), set.limit_role.end(), Role::kHit);
  if (hit != set.limit_role.end()) {
    i = static_cast<int>(hit - set.limit_role.begin());
    const LimitRow& limit = set.limits[i];
    arrival = {true, limit.before, rateAtStart(body, limit), anglesAfter(body)[limit.limit],
               step.tolerances.touching_angle};
    if (pushed) row = set.limit_row[i];
  } else {
    arrival = arrivalAt(body, step, set, i);
    if (pushed && arrival.found) row = set.row[i];
  }
  takeBack(body.memory->schur, body.total, row, arrival);
  return arrival;
}

/// Keeps the earlier of the two.
void consider(double time, Role& role, double h, Impact& first) {
  if (time < first.time) first = {std::clamp(time, 0.0, h), &role};
}

/// Whether two contacts are of the same parts, or of one and the next.
bool areNeighbours(const Contact& a, const Contact& b) {
  if (a.obstacle != b.obstacle || (a.count == 4) != (b.count == 4)) return false;
  if (a.count < 4) return a.isOfSame(b);
  const auto share = [&](int i, int j) {
    const auto isOfA = [&](int particle) {
      return particle == a.particle[i] || particle == a.particle[i + 1];
    };
    return isOfA(b.particle[j]) || isOfA(b.particle[j + 1]);
  };
  return (share(0, 0) && share(2, 2)) || (share(0, 2) && share(2, 0));
}

/// Whether a motion at whose ends the contact is open, at the end by `end`, is long enough that it
/// may be touched in between.
template <class Owner>
bool mayGraze(const Owner& owner, const StepContext& step, const ContactSet& set, std::size_t i,
              double end) {
  const Contact& c = set.contacts[i];
  const double touching = step.tolerances.touching;
  if (c.gap_start <= touching || end <= touching || c.isSoft()) return false;
  if (c.gap_start + end >= travelOf(owner, c)) return false;
  // What opens an overlap goes a way of its own.
  const Located located = locatedOf(owner);
  if (located.count >= kMaxLocated || located.overlap > kGapResolution) return false;
  // What slides on goes from one to the next of these as they are nearest in turn; and of two where
  // a stick lies flat one is nearest.
  return std::none_of(set.contacts.begin(), set.contacts.end(), [&](const Contact& other) {
    if (&other == &c || !areNeighbours(other, c)) return false;
    return std::min(other.gap_start, gapAfter(owner, other)) <= touching ||
           (other.particle == c.particle && other.gap_start < c.gap_start);
  });
}

/// The first of the contacts that are coming, or are left again before the end.
template <class Owner>
void considerContacts(const Owner& owner, const StepContext& step, ContactSet& set, double h,
                      Impact& first) {
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const Contact& c = set.contacts[i];
    const double end = gapAfter(owner, c);
    if (mayGraze(owner, step, set, i, end))
      consider(h * shareOfTouch(pathOf(owner, c, h), step.tolerances.touching), set.role[i], h,
               first);
    if (set.role[i] == Role::kComing && end < -step.tolerances.contact)
      consider(timeOfTouch(step, c, end, h), set.role[i], h, first);
  }
}

/// Of the limits.
void considerLimits(Body& body, double h, Impact& first) {
  ConstraintSet& set = body.constraints;
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    if (set.limit_role[i] != Role::kComing) continue;
    const LimitRow& limit = set.limits[i];
    const double end = anglesAfter(body)[limit.limit];
    if (end < 0) consider(timeOfTouch(body, limit, end, h), set.limit_role[i], h, first);
  }
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
  findComingContacts(body, *body.context, set, h);
  for (std::size_t i = 0; i < set.limits.size(); ++i)
    if (isComing(body, set.limits[i], h)) set.limit_role[i] = Role::kComing;
}

void findComing(Island& island, double h) {
  for (Body* body : island.bodies) findComing(*body, h);
  findComingContacts(island, island.context, island.pairs, h);
}

bool reachesComing(const Island& island) {
  const StepContext& step = island.context;
  return reachesContact(island, step, island.pairs) ||
         std::any_of(island.bodies.begin(), island.bodies.end(), [&step](const Body* body) {
           return reachesContact(*body, step, body->constraints) || reachesLimit(*body);
         });
}

Impact firstImpact(Island& island, double h) {
  const StepContext& step = island.context;
  Impact first{2 * h, nullptr};
  considerContacts(island, step, island.pairs, h, first);
  for (Body* body : island.bodies) {
    considerContacts(*body, step, body->constraints, h, first);
    considerLimits(*body, h, first);
  }
  if (!first.role) return first;
  if (first.time < kSnap * h) first.time = 0;
  if (first.time > (1 - kSnap) * h) first.time = h;
  return first;
}

void takeEdge(Island& island) {
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

void takeImpact(Island& island, const Impact& impact) {
  *impact.role = Role::kHit;
  takeEdge(island);
}

double impactAgain(const Body& body, double h) {
  const Arrival arrival = arrivalOf(body, false);
  return arrival.found ? arrival.time(h) : h;
}

double impactAgain(const Island& island, double h) {
  int i = 0;
  Arrival arrival = arrivalAt(island, island.context, island.pairs, i);
  if (arrival.found) takeBack(island.s.joint, island.s.total, island.pairs.row[i], arrival);
  for (const Body* body : island.bodies)
    if (!arrival.found) arrival = arrivalOf(*body, true);
  // What else is reached with it, on a longer lever, is to count as touching; and what has pushed
  // it back has become a speed.
  const double left = kContactTolerance / kTouching * arrival.touching;
  const bool reached = arrival.end <= left && arrival.end >= -left * h / island.context.h;
  return arrival.found && !reached ? arrival.time(h) : h;
}

}  // namespace ragdoll
