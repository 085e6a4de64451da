#include "core/direct/candidates.h"

#include <algorithm>

#include "core/contact/constants.h"
#include "core/direct/constants.h"
#include "core/direct/moving_obstacles.h"
#include "core/direct/penetration.h"
#include "core/direct/workspace.h"
#include "core/limits/constants.h"

namespace ragdoll {
namespace {

void setOffset(Body& body, Contact& c, const MotionSpan& span) {
  if (c.isSoft()) {
    c.offset = movedOffset(c, span);
    return;
  }
  c.offset = allowedOffset(c, span);
  if (!isIgnored(c, body.overlaps)) return;
  c.surface_motion.setZero();
  body.kept.setZero(3, body.n);
  c.offset = std::min(c.offset, c.offset + gapAt(body, c, body.kept.data()));
}

/// over: [s] in which what it overlaps opens, h but for what was missed.
void startContact(Body& body, Contact& c, double h, double over) {
  const double* dx = body.motion.dx.data();
  const double share = h / body.context->h;
  scaleMotion(body, h, c);
  if (body.context->relaxed) c.give = {};  // relaxation's own contacts are rigid
  c.found = c.offset;
  c.before = gapBefore(
      c, gapAt(body, c, dx) - c.normal.dot(motionOf(body, c, dx) - share * c.surface_motion));
  if (c.isSoft()) c.before = c.gap_start;  // as deep as it is, not as the plane at the end says
  setOffset(body, c, {over, over, body.context->h});
}

void startLimit(Body& body, LimitAngles::Pose& before, LimitRow& limit, double h) {
  limit.before = before[limit.limit];
  if (limit.compliance > 0)
    limit.start = std::min(0.0, limit.before);
  else
    limit.opening = allowedViolation(limit, {h, h, body.context->h}, body.overlaps);
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

bool isPassed(const Body& body, const Contact& c) {
  const std::vector<int>& passed = body.constraints.passed;
  return body.overlaps == OverlapPolicy::kPassThrough &&
         std::count(passed.begin(), passed.end(), c.obstacle) > 0;
}

/// Takes out the contacts with the obstacles that the body is in.
void passThrough(Body& body) {
  std::vector<Contact>& all = body.constraints.contacts;
  double deepest = 0;
  for (const Contact& c : all) deepest = std::min(deepest, c.gap_start);
  body.constraints.passed.clear();
  for (const Contact& c : all)
    if (c.gap_start < 0.5 * deepest) body.constraints.passed.push_back(c.obstacle);
  all.erase(
      std::remove_if(all.begin(), all.end(), [&](const Contact& c) { return isPassed(body, c); }),
      all.end());
}

}  // namespace

double gapAt(const Body& body, const Contact& c, const double* dx) {
  double gap = -c.offset;
  for (int k = 0; k < c.count; ++k) {
    const int i = c.particle[k];
    gap += c.weight[k] * c.normal.dot(body.context->state.x.col(i) +
                                      Eigen::Map<const Vec3>(dx + 3 * (i - body.first)));
  }
  return gap;
}

Vec3 motionOf(const Body& body, const Contact& c, const double* dx) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < c.count; ++k)
    sum += c.weight[k] * Eigen::Map<const Vec3>(dx + 3 * (c.particle[k] - body.first));
  return sum;
}

double openingRate(const Body& body, const Contact& c) {
  return c.normal.dot(motionOf(body, c, body.vData()) - c.surface_motion / body.context->h);
}

bool isKnown(const std::vector<Contact>& contacts, std::size_t count, const Contact& contact) {
  const auto end = contacts.begin() + static_cast<std::ptrdiff_t>(count);
  return std::any_of(contacts.begin(), end, [&](const Contact& c) { return c.isOfSame(contact); });
}

void findCandidates(Body& body, double h) {
  ConstraintSet& set = body.constraints;
  const StepContext& step = *body.context;
  set.contacts.clear();
  set.limits.clear();
  set.limit_role.clear();
  if (step.ws.obstacles.empty() && body.skeleton->joints.empty() && !step.model.self_collision)
    return;
  appendNear(body, h, set.contacts);
  if (body.overlaps == OverlapPolicy::kPassThrough) passThrough(body);
  set.overlap = 0;
  for (Contact& c : set.contacts) {
    startContact(body, c, h, h);
    if (!c.isSoft()) set.overlap = std::max(set.overlap, -c.gap_start);
  }
  set.role.assign(set.contacts.size(), Role::kIfNear);
  if (body.isWhole()) addLimits(body, kNearLimit, h, Role::kIfNear);
}

// What moves keeps its plane: found anew, one of 600 random driven scenes gained 1.1 % of energy.
bool hasOtherPlane(const Body& body, const Contact& c, double over) {
  if (!c.touches_at_start || c.isSoft() || !c.surface_motion.isZero(0)) return false;
  const double seen = c.gapAt(body.context->state.x) + c.offset - c.found;
  return (c.normal - c.start_normal).norm() > kTurned ||
         std::abs(seen - c.gap_start) > body.context->tolerances.contact * over / body.context->h;
}

bool hasOtherPlane(const Body& body, const std::vector<Contact>& contacts, double over) {
  return std::any_of(contacts.begin(), contacts.end(),
                     [&](const Contact& c) { return hasOtherPlane(body, c, over); });
}

bool findAnew(const std::vector<Contact>& found, Contact& c) {
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

void findContactsAnew(Body& body, double over) {
  ConstraintSet& set = body.constraints;
  if (!hasOtherPlane(body, set.contacts, over)) return;
  set.missed.clear();
  appendNear(body, over, set.missed);
  for (Contact& c : set.contacts)
    if (hasOtherPlane(body, c, over) && findAnew(set.missed, c)) startContact(body, c, over, over);
}

void limitDepenetration(Body& body, double h, double substep) {
  const MotionSpan span{h, substep, body.context->h};
  for (Contact& c : body.constraints.contacts) setOffset(body, c, span);
  for (LimitRow& limit : body.constraints.limits)
    if (limit.compliance == 0) limit.opening = allowedViolation(limit, span, body.overlaps);
}

bool addLimits(Body& body, double margin, double h, Role role) {
  const std::vector<Limit>& limits = body.skeleton->limits;
  ConstraintSet& set = body.constraints;
  if (limits.empty()) return false;
  const std::size_t known = set.limits.size();
  LimitAngles::Pose &angles = anglesAfter(body), *before = nullptr;
  for (int k = 0; k < static_cast<int>(limits.size()); ++k) {
    if (angles.isBeyond(k, margin)) continue;
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
  bool any = limits && addLimits(body, -kGapResolution / kLever, step.h, Role::kActive);
  set.missed.clear();
  if (!step.ws.obstacles.empty()) {
    const std::vector<SweptObstacle>& swept = obstaclesOver(body, h);
    appendContacts(step.model, swept, step.state.x, after, body.index, 0, set.missed);
    appendStickOverlaps(step.model, swept, step.state.x, after, body.index, kSlop, set.missed);
  }
  const std::size_t obstacles = set.missed.size(), known = set.contacts.size();
  if (step.model.self_collision)
    body.detector.appendSelf(step.model, step.state.x, after, body.index,
                             PairSearch::overlaps(kSlop), set.missed);
  for (std::size_t i = 0; i < set.missed.size(); ++i) {
    Contact& c = set.missed[i];
    if (isPassed(body, c)) continue;
    const bool rigid = step.relaxed || !c.isSoft();
    if (!rigid && isKnown(set.contacts, known, c)) continue;  // its spring overlaps
    startContact(body, c, h, i < obstacles && rigid ? step.h : h);
    if (i < obstacles && rigid)  // what overlaps opens in a part of a step by a part of it
      c.offset = std::min(c.offset, c.found - std::max(0.0, -c.gap_start - recoverySpeed(c) * h));
    if (gapAfter(body, c) >= (i < obstacles ? -kGapResolution : -kSlop)) continue;
    set.contacts.push_back(c);
    set.role.push_back(Role::kActive);
    any = true;
  }
  return any;
}

bool activateViolated(Body& body) {
  ConstraintSet& set = body.constraints;
  bool any = false;
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    if (set.row[i] >= 0 || set.role[i] == Role::kComing) continue;
    if (gapAfter(body, set.contacts[i]) >= -body.context->tolerances.contact) continue;
    set.role[i] = Role::kActive;
    any = true;
  }
  if (set.limits.empty()) return any;
  LimitAngles::Pose& angles = anglesAfter(body);
  for (std::size_t i = 0; i < set.limits.size(); ++i) {
    if (set.limit_row[i] >= 0 || set.limit_role[i] == Role::kComing) continue;
    const int k = set.limits[i].limit;
    if (angles.isBeyond(k, 0) || angles[k] * kLever >= -body.context->tolerances.contact) continue;
    set.limit_role[i] = Role::kActive;
    any = true;
  }
  return any;
}

void activateAll(Body& body) {
  for (std::vector<Role>* roles : {&body.constraints.role, &body.constraints.limit_role})
    std::replace(roles->begin(), roles->end(), Role::kIfNear, Role::kActive);
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
