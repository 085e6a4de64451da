#include "core/direct/smooth_motion.h"

#include <algorithm>
#include <cmath>

#include "core/direct/angular_momentum.h"
#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/contact_motion.h"
#include "core/direct/driving.h"
#include "core/direct/edges.h"
#include "core/direct/graze.h"
#include "core/direct/impact.h"
#include "core/direct/mode_events.h"
#include "core/direct/motion.h"
#include "core/direct/velocity_solver.h"

namespace ragdoll {
namespace {

Drive driveOf(Body& body) {
  if (!forcesFollow(body)) return {};
  return
      [&body](const double* x, const double* v, Points& free) { return drive(body, x, v, free); };
}

/// What a motion comes to beside its dx.
struct SmoothEnd {
  bool ok = false;            ///< it was found
  double work = 0;            ///< [J] of what is counted in Body::given
  const Points* v = nullptr;  ///< [m/s], in the body's scratch
};

/// Dormand-Prince 5 over h, no matter what it meets.
SmoothEnd integrate(Body& body, double h) {
  double* m = body.multipliers();
  // A pin is faster or slower from this step on, or has stopped, and what hangs on it with it.
  if (!body.pinned->pins.empty()) {
    body.memory->response.setStart(body.xData());
    body.memory->response.projectAtStart(body.vData());
  }
  const double work =
      rungeKutta(body.memory->response, body.xData(), body.vData(), body.acceleration,
                 driveOf(body), h, body.stages, body.motion.dx, body.v1, m);
  const int s = body.rows->s;
  for (int k = 0; k < s; ++k) m[k] = m[k + s] = 0.5 * m[k];  // per h^2 of x, not of v
  driveAt(body, body.xData());
  body.motion.lambda.setZero(body.rows->width);
  const bool ok = satisfySticks(body);
  // From event to event, where each piece has lengths to 1e-13 m, two motions that come to lie in
  // more places than hold them are handed over with it.
  if (ok && !body.context->events)
    body.memory->response.polishAlongStart(body.lengths, body.motion.dx);
  return {ok, work, &body.v1};
}

/// Whether something touches at either end of the motion, but for what is coming. gap: [m] of a
/// contact at the start.
template <class Gap>
bool touchesOnTheWay(const Body& body, const Gap& gap) {
  const double touching = body.context->tolerances.touching;
  const ConstraintSet& set = body.constraints;
  for (std::size_t i = 0; i < set.contacts.size(); ++i) {
    const Contact& c = set.contacts[i];
    if (set.role[i] == Role::kComing) continue;
    if (c.runs || gap(c) <= touching || gapAfter(body, c) <= touching) return true;
  }
  for (std::size_t i = 0; i < set.limits.size(); ++i)
    if (set.limit_role[i] != Role::kComing &&
        (set.limits[i].value <= 0 || set.limits[i].start != 0))
      return true;
  return false;
}

/// Whether something pressed at the end of a motion from event to event. That sees a stick as near
/// to its ends as it touches; candidates there are its ends, which may be clear of what it lies on.
bool pressesInMode(const Body& body) {
  return body.context->events && !body.cache.impulses().empty();
}

/// Whether a limit that touches at the start may press and let go within the motion: from event to
/// event that is followed.
bool mayPressUnseen(const Body& body) {
  const std::vector<LimitRow>& limits = body.constraints.limits;
  return body.context->events && std::any_of(limits.begin(), limits.end(), [&](const LimitRow& l) {
           return l.before <= body.context->tolerances.touching_angle;
         });
}

/// Whether nothing touches on the way, over h.
bool isFree(const Body& body, double h) {
  return !pressesInMode(body) && !mayPressUnseen(body) &&
         !touchesOnTheWay(body, [](const Contact& c) { return c.gap_start; }) &&
         timeOfTip(body, h) > h;
}

/// Returns the error [m] of a motion over h in a part of a step.
double take(Body& body, const SmoothEnd& end, double h) {
  body.cache.clear();
  body.given += end.work;
  const Vec3 angular = angularMomentumAt(body, body.x(), body.v());
  body.x() += body.motion.dx;
  driveAt(body, body.xData());
  body.v() = *end.v;
  BodyResponse& response = body.memory->response;
  response.setEnd(body.xData());
  response.projectAtEnd(body.vData());
  response.endIsStart();
  restoreInFlight(body, angular, h);
  if (!body.context->isPart()) return 0;
  return rungeKuttaError(response, body.xData(), body.vData(), driveOf(body), h, body.stages);
}

/// Something touches.
SmoothTrial leaveToLeapfrog() {
  SmoothTrial trial;
  trial.is_left = true;
  return trial;
}

/// After a motion over h that met something: moves to where that is reached and takes the impact.
SmoothTrial stopAtImpact(Island& island, double h) {
  Body& body = *island.bodies[0];
  findComing(body, h);
  // What comes has its time by the plane that it reaches: so has what else touches.
  if (touchesOnTheWay(body, [](const Contact& c) { return c.before; })) return leaveToLeapfrog();
  const Impact impact = firstImpact(island, h);
  if (impact.time > h) return leaveToLeapfrog();
  takeImpact(island, impact);
  double until = impact.time;
  SmoothEnd end;
  for (int i = 0; i < kRefinements && until > 0; ++i) {
    end = integrate(body, until);
    if (!end.ok) return {until, false};
    findContactsAnew(body, until, h);
    if (body.driven)
      limitDepenetration(body, until, h);  // planes that move are where they are then
    const double better = std::min(impactAgain(body, until), h);
    if (i + 1 == kRefinements || std::abs(better - until) < kSnap * h) break;
    until = better;
  }
  SmoothTrial trial{std::max(until, 0.0)};
  if (until > 0)
    trial.error = take(body, end, until);
  else
    placeAtStart(island);
  bounce(island);
  return trial;
}

}  // namespace

SmoothTrial moveSmoothly(Island& island, double h) {
  Body& body = *island.bodies[0];
  SmoothTrial trial{h};
  SmoothEnd end = integrate(body, h);
  findCandidates(body, h);
  const bool free = end.ok && isFree(body, h);
  const double graze = free ? timeOfGraze(body, *end.v, h) : h;
  if (free && graze == h) {
    trial.error = take(body, end, h);
    return trial;
  }
  if (moveThroughEvents(island, h, trial.contacts, trial.error)) {
    trial.exact = true;
    return trial;
  }
  if (end.ok) end = integrate(body, graze);
  findCandidates(body, graze);
  trial.took = graze;
  trial.ok = end.ok;
  if (!trial.ok) return trial;
  if (!free || !isFree(body, graze)) return stopAtImpact(island, graze);
  trial.error = take(body, end, graze);
  return trial;
}

SmoothTrial moveTogether(Island& island, double h) {
  for (Body* body : island.bodies) {  // for who judges it: which limits it comes near
    body->motion.dx = h * body->v();
    findCandidates(*body, h);
  }
  SmoothTrial trial{h};
  trial.exact = moveThroughEvents(island, h, trial.contacts, trial.error);
  return trial.exact ? trial : leaveToLeapfrog();
}

bool moveFreely(Island& island, double h, double& error) {
  Body& body = *island.bodies[0];
  const SmoothEnd end = integrate(body, h);
  findCandidates(body, h);
  if (!end.ok || !isFree(body, h) || timeOfGraze(body, *end.v, h) < h) return false;
  error = take(body, end, h);
  return std::isfinite(error);
}

}  // namespace ragdoll
