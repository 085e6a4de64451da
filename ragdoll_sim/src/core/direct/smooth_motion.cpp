#include "core/direct/smooth_motion.h"

#include <algorithm>
#include <cmath>

#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/driving.h"
#include "core/direct/impact.h"
#include "core/direct/motion.h"
#include "core/direct/step_island.h"
#include "core/direct/velocity_solver.h"

namespace ragdoll {
namespace {

constexpr int kRefinements = 3;     ///< of the time at which rk arrives
constexpr int kMaxAdaptive = 1024;  ///< substeps of one step; as small as they get

Drive driveOf(Body& body) {
  if (!forcesFollow(body)) return {};
  return
      [&body](const double* x, const double* v, Points& free) { return drive(body, x, v, free); };
}

/// Dormand-Prince 5 over h, no matter what it meets: the motion, and velocities body.v1.
bool integrate(Body& body, double h) {
  double* m = body.multipliers();
  rungeKutta(body.memory->response, body.xData(), body.vData(), body.acceleration, driveOf(body), h,
             body.stages, body.motion.dx, body.v1, m);
  const int s = body.rows->s;
  for (int k = 0; k < s; ++k) m[k] = m[k + s] = 0.5 * m[k];  // per h^2 of x, not of v
  driveAt(body, body.xData());
  body.motion.lambda.setZero(body.rows->width);
  return satisfySticks(body);
}

/// Whether nothing touches on the way.
bool isFree(const Body& body) {
  for (const Contact& c : body.constraints.contacts)
    if (gapAfter(body, c) <= body.tolerances.touching || c.gap_start <= body.tolerances.touching)
      return false;
  for (const LimitRow& l : body.constraints.limits)
    if (l.value <= 0 || l.start != 0) return false;
  return true;
}

void take(Body& body) {
  body.cache.clear();
  body.given += body.stages.work;
  body.x() += body.motion.dx;
  driveAt(body, body.xData());
  body.v() = body.v1;
  BodyResponse& response = body.memory->response;
  response.setEnd(body.xData());
  response.projectAtEnd(body.vData());
  response.endIsStart();
}

/// After a motion over h that met something: moves to where that is reached and takes the impact.
SmoothTrial stopAtImpact(Island& island, double h) {
  Body& body = *island.bodies[0];
  findComing(body, h);
  if (touchesOther(body)) return {0, true};
  const Impact impact = firstImpact(island, h);
  if (impact.time > h) return {0, true};
  takeImpact(island, impact);
  double until = impact.time;
  for (int i = 0; i < kRefinements && until > 0; ++i) {
    if (!integrate(body, until)) return {until, false};
    const double better = std::min(impactAgain(body, until), h);
    if (i + 1 == kRefinements || std::abs(better - until) < kSnap * h) break;
    until = better;
  }
  if (until > 0) take(body);
  bounce(island);
  return {std::max(until, kSnap * h), true};
}

/// How far a step of h has come in substeps that keep the tolerance.
struct AdaptiveStep {
  double h;      ///< [s]
  double& next;  ///< [s] the substep to try next; in the state, as the next step begins with it
  double left;   ///< [s]
  int taken = 0;

  void accept(double took) {
    left -= took;
    ++taken;
  }
};

/// After a motion over sub that met something; whole: it was found.
void meet(Island& island, AdaptiveStep& step, double sub, bool whole, StepReport& report) {
  const SmoothTrial impact = whole ? stopAtImpact(island, sub) : SmoothTrial{0, false};
  if (impact.ok && impact.took != 0) return step.accept(impact.took);
  restore(island);  // contacts and limits that press: the order is theirs
  takeSubsteps(island, sub, report);
  step.next = std::min(2 * sub, step.h);
  step.accept(sub);
}

/// After a free motion over sub: accepted if its error is small enough, or it cannot be smaller.
void judge(Island& island, AdaptiveStep& step, double sub, bool whole, StepReport& report) {
  Body& body = *island.bodies[0];
  const double tolerance = island.context.model.solver.tolerance;
  const bool least = sub < 1.01 * step.h / kMaxAdaptive;
  take(body);
  const double rate =
      rungeKuttaError(body.memory->response, body.xData(), body.vData(), driveOf(body), sub,
                      body.stages) /
      sub;
  const bool ok = whole && rate < 1e300;
  if (!ok && least) {  // not for an explicit method
    restore(island);
    takeSubsteps(island, step.left, report);
    step.left = 0;
    return;
  }
  // The estimate is of fourth order, so that its rate falls with the fourth power of the substep.
  const double growth =
      ok ? kSafety * std::pow(std::max(rate / tolerance, 1e-12), -0.25) : 1 / kLargestGrowth;
  step.next = sub * std::clamp(growth, 1 / kLargestGrowth, kLargestGrowth);
  if (!ok || (rate > tolerance && !least)) return restore(island);
  report.unresolved += rate > tolerance;
  step.accept(sub);
}

}  // namespace

SmoothTrial moveSmoothly(Island& island, double h) {
  Body& body = *island.bodies[0];
  const bool whole = integrate(body, h);
  findCandidates(body, h);
  if (!whole) return {h, false};
  if (!isFree(body)) return stopAtImpact(island, h);
  take(body);
  return {h, true};
}

void stepWithinTolerance(Island& island, double h, StepReport& report) {
  Body& body = *island.bodies[0];
  AdaptiveStep step{h, body.multipliers()[2 * body.rows->s], h};
  if (!(step.next > 0)) step.next = h;
  while (step.left > kNothingLeft * h) {
    const double sub = step.left / std::ceil(step.left / std::min(step.next, step.left) - 1e-6);
    save(island);
    const bool whole = integrate(body, sub);
    findCandidates(body, sub);
    if (isFree(body))
      judge(island, step, sub, whole, report);
    else
      meet(island, step, sub, whole, report);
  }
  report.substeps = std::max(report.substeps, step.taken);
}

}  // namespace ragdoll
