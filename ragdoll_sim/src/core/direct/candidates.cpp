#include "core/direct/candidates.h"

#include <algorithm>

#include "core/contact/axis.h"
#include "core/contact/constants.h"
#include "core/contact/detect.h"
#include "core/direct/constants.h"
#include "core/direct/contact_motion.h"
#include "core/direct/moving_obstacles.h"
#include "core/direct/penetration.h"
#include "core/direct/workspace.h"
#include "core/limits/constants.h"

namespace ragdoll {
namespace {

OverlapPolicy overlapsOf(const Body& body) { return body.overlaps; }
/// Between bodies no overlap is given up.
OverlapPolicy overlapsOf(const Island&) { return OverlapPolicy::kResolve; }

template <class Owner>
void setOffset(const Owner& owner, Contact& c, const MotionSpan& span) {
  c.offset = allowedOffset(c, span);
  if (c.isSoft() || !isIgnored(c, overlapsOf(owner))) return;
  c.surface_motion = c.surface_start = c.surface_end = Vec3::Zero();
  c.offset = std::min(c.offset, c.offset + c.gapAt(contextOf(owner).state.x));
}

/// Of a motion over h. over: [s] in which what it overlaps opens, h but for what was missed.
template <class Owner>
void startContact(const Owner& owner, Contact& c, double h, double over) {
  const StepContext& step = contextOf(owner);
  scaleMotion(step, h, c);
  if (step.relaxed) c.give = {};  // relaxation's own contacts are rigid
  c.found = c.offset;
  const double moved = h / step.h * c.normal.dot(c.surface_motion);
  c.before = c.isSoft() ? c.gap_start : gapBefore(c, c.gapAt(step.state.x) + moved);
  setOffset(owner, c, {over, over, step.h});
}

template <class Owner>
void startContacts(const Owner& owner, ContactSet& set, double h) {
  for (Contact& c : set.contacts) startContact(owner, c, h, h);
  set.role.assign(set.contacts.size(), Role::kIfNear);
}

void startLimit(Body& body, LimitAngles::Pose& before, LimitRow& limit, double h) {
  limit.before = before[limit.limit];
  if (limit.isSoft())
    limit.start = std::min(0.0, limit.before);
  else
    limit.opening = allowedViolation(limit, {h, h, body.context->h}, body.overlaps);
}

/// Where the bodies' motions lead, sleepers where they are; as poseAfter.
const Points& posesAfter(const Island& island) {
  const StepContext& step = island.context;
  for (const Body* body : island.bodies) poseAfter(*body);
  Points& poses = posesOf(step);
  placeSleepers(island, poses);
  return poses;
}

/// Contacts of the motion over h with obstacles and with the body itself.
void appendNear(Body& body, double h, std::vector<Contact>& contacts) {
  const StepContext& step = *body.context;
  const Points& after = poseAfter(body);
  if (!step.ws.obstacles.empty())
    appendContacts(step.model, obstaclesOver(body, h), step.state.x, after, body.index, kNearBody,
                   contacts);
  if (step.model.self_collision)
    body.detector.appendSelf(step.model, step.state.x, after, body.index,
                             PairSearch::touches(kNearBody), contacts);
}

void appendBetween(Island& island, PairSearch search, std::vector<Contact>& contacts) {
  const StepContext& step = island.context;
  island.s.detector.appendBetween(step.model, step.state, island.s.all, step.state.x,
                                  posesAfter(island), search, contacts);
}

void appendNear(Island& island, double, std::vector<Contact>& contacts) {
  appendBetween(island, PairSearch::touches(kNearBody), contacts);
}

bool isFiltered(const Body& body, const Contact& c) {
  const std::vector<int>& filtered = body.constraints.filtered;
  return body.overlaps == OverlapPolicy::kFilter &&
         std::count(filtered.begin(), filtered.end(), c.obstacle) > 0;
}

/// Collision filtering: takes out the contacts with obstacles that the body is dragged through.
void filter(const Body& body, std::vector<Contact>& contacts) {
  if (body.overlaps != OverlapPolicy::kFilter) return;
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(),
                                [&](const Contact& c) { return isFiltered(body, c); }),
                 contacts.end());
}

/// Those that it is in.
void findFiltered(ConstraintSet& set) {
  double deepest = 0;
  for (const Contact& c : set.contacts) deepest = std::min(deepest, c.gap_start);
  set.filtered.clear();
  for (const Contact& c : set.contacts)
    if (c.gap_start < kFilteredDepth * deepest) set.filtered.push_back(c.obstacle);
}

/// Whether what touches all along does so elsewhere on its stick in the end.
bool hasMoved(const Contact& c) {
  for (int k = 0; k < c.count; ++k)
    if (std::abs(c.weight[k] - c.start_weight[k]) > kTurned) return true;
  return false;
}

/// Whether what touches all along has another plane than a motion over `over` would: it is turned,
/// or seen from the start of the substep it lies elsewhere than what touches there, by more than
/// may be left in such a part of a step, where it becomes a speed.
bool hasOtherPlane(const StepContext& step, const Contact& c, double over, double substep) {
  if (!c.touches_at_start || c.isSoft()) return false;
  const double moved = substep / step.h * c.normal.dot(c.surface_motion);
  const double seen = c.gapAt(step.state.x) + c.offset - c.found + moved;
  return (c.normal - c.start_normal).norm() > kTurned || hasMoved(c) ||
         std::abs(seen - c.gap_start) > step.tolerances.contact * over / step.h;
}

/// Has the contact as it is among those that are found now, at the place nearest to its own;
/// whether it is there.
bool takeNearest(const std::vector<Contact>& found, Contact& c) {
  const Contact* nearest = nullptr;
  const auto away = [&c](const Contact& other) { return std::abs(other.weight[1] - c.weight[1]); };
  for (const Contact& other : found) {
    if (other.obstacle != c.obstacle || other.count != c.count || other.particle != c.particle)
      continue;
    if (!nearest || away(other) < away(*nearest)) nearest = &other;
  }
  if (nearest) c = *nearest;
  return nearest;
}

/// Whether what is hit, or may be with it, has the plane that the whole motion's chord reaches: the
/// way there is curved.
bool isHitElsewhere(const StepContext& step, const Contact& c, Role role) {
  if (!isReached(role) || c.touches_at_start) return false;
  if (c.obstacle < 0) return true;
  return step.model.obstacles[c.obstacle].type != ObstacleSpec::Type::kPlane ||
         c.surface_end != c.surface_motion;
}

/// Has the contact of a stick that has none any more, as its place stays at one of its ends, be
/// that end's; whether it touches. found: where contacts are put meanwhile.
bool takeEnd(Body& body, double over, std::vector<Contact>& found, Contact& c) {
  const bool ends = c.count == 2 && c.touches_at_start && !isBetweenEnds(c.start_weight[1]);
  if (!ends || c.obstacle < 0) return false;
  const StepContext& step = *body.context;
  const std::vector<SweptObstacle>& swept = obstaclesOver(body, over);
  const auto obstacle = std::find_if(
      swept.begin(), swept.end(), [&c](const SweptObstacle& m) { return m.index == c.obstacle; });
  const int particle = c.particle[c.start_weight[1] < 0.5 ? 0 : 1] - body.first;
  const std::size_t known = found.size();
  appendParticleContact(step.model, *obstacle, step.state.x, poseAfter(body), body.index, particle,
                        kNearBody, found);
  if (found.size() == known) return false;
  c = found.back();
  found.pop_back();
  return true;
}
/// Between bodies ends are the sticks'.
bool takeEnd(Island&, double, std::vector<Contact>&, Contact&) { return false; }

template <class Owner>
void findAnew(Owner& owner, ContactSet& set, double over, double substep) {
  const StepContext& step = contextOf(owner);
  const auto isOther = [&](std::size_t i) {
    const Contact& c = set.contacts[i];
    return hasOtherPlane(step, c, over, substep) || isHitElsewhere(step, c, set.role[i]) || c.runs;
  };
  std::vector<Contact>& near = set.scratch;
  near.clear();
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    if (!isOther(i)) continue;
    if (near.empty()) appendNear(owner, over, near);
    Contact& c = set.contacts[i];
    if (!takeNearest(near, c) && !takeEnd(owner, over, near, c)) continue;
    startContact(owner, c, over, over);
    c.found += (substep - over) / step.h * c.normal.dot(c.surface_motion);
  }
}

void placeAtStart(const StepContext& step, ContactSet& set) {
  for (Contact& c : set.contacts) {
    if (!c.touches_at_start || c.isSoft()) continue;
    c = c.atStart();
    c.offset += c.gapAt(step.state.x) - c.gap_start;
  }
}

/// Whether one of the same surfaces is among the first `count` contacts.
bool isKnown(const std::vector<Contact>& contacts, std::size_t count, const Contact& contact) {
  const auto end = contacts.begin() + static_cast<std::ptrdiff_t>(count);
  return std::any_of(contacts.begin(), end, [&](const Contact& c) { return c.isOfSame(contact); });
}

/// What overlaps an obstacle opens over the step, in a part of it by a part of it.
template <class Owner>
void startMissed(const Owner& owner, Contact& c, double h) {
  const StepContext& step = contextOf(owner);
  const bool opens = c.obstacle >= 0 && (step.relaxed || !c.isSoft());
  startContact(owner, c, h, opens ? step.h : h);
  if (opens)
    c.offset = std::min(c.offset, c.found - std::max(0.0, -c.gap_start - recoverySpeed(c) * h));
}

/// Adds those of `found` that the motions go into; whether there are any.
template <class Owner>
bool takeMissed(const Owner& owner, std::vector<Contact>& found, ContactSet& set, double h) {
  const std::size_t known = set.contacts.size();
  for (Contact& c : found) {
    startMissed(owner, c, h);
    if (c.isSoft() && isKnown(set.contacts, known, c)) continue;  // its spring overlaps
    if (gapAfter(owner, c) >= (c.obstacle >= 0 ? -kGapResolution : -kSlop)) continue;
    set.contacts.push_back(c);
    set.role.push_back(Role::kActive);
  }
  return set.contacts.size() > known;
}

template <class Owner>
bool activateViolated(const Owner& owner, ContactSet& set, double left) {
  bool any = false;
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    if (set.row[i] >= 0 || set.role[i] == Role::kComing) continue;
    if (gapAfter(owner, set.contacts[i]) >= -left) continue;
    set.role[i] = Role::kActive;
    any = true;
  }
  return any;
}

}  // namespace

void findCandidates(Body& body, double h) {
  ConstraintSet& set = body.constraints;
  const StepContext& step = *body.context;
  set.contacts.clear();
  set.limits.clear();
  set.limit_role.clear();
  if (step.ws.obstacles.empty() && body.skeleton->joints.empty() && !step.model.self_collision)
    return;
  appendNear(body, h, set.contacts);
  if (body.overlaps == OverlapPolicy::kFilter) findFiltered(set);
  filter(body, set.contacts);
  startContacts(body, set, h);
  set.overlap = 0;
  for (const Contact& c : set.contacts)
    if (!c.isSoft()) set.overlap = std::max(set.overlap, -c.gap_start);
  if (body.isWhole()) addLimits(body, kNearLimit, h, Role::kIfNear);
}

void findCandidates(Island& island, double h) {
  for (Body* body : island.bodies) findCandidates(*body, h);
  island.pairs.contacts.clear();
  if (island.isLone()) return;
  appendNear(island, h, island.pairs.contacts);
  startContacts(island, island.pairs, h);
}

void findContactsAnew(Body& body, double over, double substep) {
  findAnew(body, body.constraints, over, substep);
}

void findContactsAnew(Island& island, double over, double substep) {
  for (Body* body : island.bodies) findContactsAnew(*body, over, substep);
  findAnew(island, island.pairs, over, substep);
}

void placeAtStart(Island& island) {
  for (Body* body : island.bodies) placeAtStart(island.context, body->constraints);
  placeAtStart(island.context, island.pairs);
}

void limitDepenetration(Body& body, double h, double substep) {
  const MotionSpan span{h, substep, body.context->h};
  for (Contact& c : body.constraints.contacts) setOffset(body, c, span);
  for (LimitRow& limit : body.constraints.limits)
    if (!limit.isSoft()) limit.opening = allowedViolation(limit, span, body.overlaps);
}

void limitDepenetration(Island& island, double h, double substep) {
  for (Body* body : island.bodies) limitDepenetration(*body, h, substep);
  for (Contact& c : island.pairs.contacts) setOffset(island, c, {h, substep, island.context.h});
}

bool addLimits(Body& body, double margin, double h, Role role) {
  const std::vector<Limit>& limits = body.skeleton->limits;
  ConstraintSet& set = body.constraints;
  if (limits.empty()) return false;
  const std::size_t known = set.limits.size();
  LimitAngles::Pose &angles = anglesAfter(body), *before = nullptr;
  // A wedge may be far from where it pressed: its tip was on the way.
  const auto pressedAtWedge = [&](int k) {
    return limits[k].kind == Limit::Kind::kWedge &&
           body.cache.find(limitRow(body.context->model, body.index, k)) != nullptr;
  };
  for (int k = 0; k < static_cast<int>(limits.size()); ++k) {
    if (angles.isBeyond(k, margin) && !pressedAtWedge(k)) continue;
    const auto same = [k](const LimitRow& l) { return l.limit == k; };
    const auto end = set.limits.begin() + static_cast<std::ptrdiff_t>(known);
    if (std::any_of(set.limits.begin(), end, same)) continue;
    LimitRow& row = set.limits.emplace_back(limitRow(body.context->model, body.index, k));
    row.value = angles[k];
    if (!before) before = &anglesBefore(body);
    startLimit(body, *before, row, h);
    set.limit_role.push_back(role);
  }
  return set.limits.size() > known;
}

bool findMissed(Body& body, double h) {
  const StepContext& step = *body.context;
  ConstraintSet& set = body.constraints;
  // The relaxation leaves sticks off their lengths, too, but not so far.
  const bool limits = body.isWhole() || step.relaxed;
  const Points& after = poseAfter(body);
  const bool any = limits && addLimits(body, -kGapResolution / kLever, step.h, Role::kActive);
  std::vector<Contact>& found = set.scratch;
  found.clear();
  if (!step.ws.obstacles.empty()) {
    const std::vector<SweptObstacle>& swept = obstaclesOver(body, h);
    appendContacts(step.model, swept, step.state.x, after, body.index, 0, found);
    appendStickOverlaps(step.model, swept, step.state.x, after, body.index, kSlop, found);
  }
  if (step.model.self_collision)
    body.detector.appendSelf(step.model, step.state.x, after, body.index,
                             PairSearch::overlaps(kSlop), found);
  filter(body, found);
  return takeMissed(body, found, set, h) || any;
}

bool findMissed(Island& island, double h) {
  bool any = false;
  for (Body* body : island.bodies) any = findMissed(*body, h) || any;
  if (island.isLone()) return any;
  std::vector<Contact>& found = island.pairs.scratch;
  found.clear();
  appendBetween(island, PairSearch::overlaps(kSlop), found);
  return takeMissed(island, found, island.pairs, h) || any;
}

bool activateViolated(Body& body) {
  ConstraintSet& set = body.constraints;
  const double left = body.context->tolerances.contact;
  bool any = activateViolated(body, set, left);
  if (set.limits.empty()) return any;
  LimitAngles::Pose& angles = anglesAfter(body);
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    if (set.limit_row[i] >= 0 || set.limit_role[i] == Role::kComing) continue;
    const int k = set.limits[i].limit;
    if (angles.isBeyond(k, 0) || angles[k] * kLever >= -left) continue;
    set.limit_role[i] = Role::kActive;
    any = true;
  }
  return any;
}

bool activateViolated(Island& island) {
  bool any = false;
  for (Body* body : island.bodies) any = activateViolated(*body) || any;
  return activateViolated(island, island.pairs, island.context.tolerances.contact) || any;
}

void activateAll(Island& island) {
  const auto activate = [](std::vector<Role>& roles) {
    std::replace(roles.begin(), roles.end(), Role::kIfNear, Role::kActive);
  };
  activate(island.pairs.role);
  for (Body* body : island.bodies) {
    activate(body->constraints.role);
    activate(body->constraints.limit_role);
  }
}

bool isSqueezed(const Body& body) {
  if (body.constraints.overlap <= kClose) return false;
  const std::vector<Contact>& all = body.constraints.contacts;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].gap_start > -kTouching || all[i].isSoft()) continue;
    if (all[i].count == 4) return true;
    for (std::size_t j = 0; j < all.size(); ++j)
      if (all[j].gap_start < kTouching && all[i].normal.dot(all[j].normal) < 0) return true;
  }
  return false;
}

}  // namespace ragdoll
