#include "core/direct/smooth_motion.h"

#include <algorithm>
#include <cmath>

#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/impact.h"
#include "core/direct/motion.h"
#include "core/direct/step_island.h"
#include "core/direct/velocity_solver.h"

namespace ragdoll {
namespace {

constexpr int kRefinements = 3;     ///< of the time at which rk arrives
constexpr int kMaxAdaptive = 1024;  ///< substeps of one step; as small as they get

/// Dormand-Prince 5 over h, no matter what it meets: the motion, and velocities body.v1.
bool integrate(Body& body, double h) {
  double* m = body.multipliers();
  BodyResponse& response = body.memory->response;
  rungeKutta(*body.rows, response.start(), response.end(), body.xData(), body.vData(),
             body.acceleration, h, body.stages, body.motion.dx, body.v1, m);
  const int s = body.rows->s;
  for (int k = 0; k < s; ++k) m[k] = m[k + s] = 0.5 * m[k];  // per h^2 of x, not of v
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
  body.x() += body.motion.dx;
  body.v() = body.v1;
  BodyResponse& response = body.memory->response;
  response.setEnd(body.xData());
  response.projectAtEnd(body.vData());
  response.endIsStart();
}

/// After a motion over h that met something: moves to where that is reached and takes the impact.
SmoothTrial moveToImpact(Island& island, double h) {
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

}  // namespace

SmoothTrial moveSmoothly(Island& island, double h) {
  Body& body = *island.bodies[0];
  const bool whole = integrate(body, h);
  findCandidates(body, h);
  if (!whole) return {h, false};
  if (!isFree(body)) return moveToImpact(island, h);
  take(body);
  return {h, true};
}

void stepWithinTolerance(Island& island, double h, StepReport& report) {
  Body& body = *island.bodies[0];
  const double tolerance = island.context.model.solver.tolerance;
  double& next = body.multipliers()[2 * body.rows->s];
  if (!(next > 0)) next = h;
  double left = h;
  int taken = 0;
  while (left > kNothingLeft * h) {
    const double sub = left / std::ceil(left / std::min(next, left) - 1e-6);
    const bool least = sub < 1.01 * h / kMaxAdaptive;
    save(island);
    bool ok = integrate(body, sub);
    findCandidates(body, sub);
    if (!isFree(body)) {
      const SmoothTrial impact = ok ? moveToImpact(island, sub) : SmoothTrial{0, false};
      double took = impact.took;
      if (!impact.ok || took == 0) {  // contacts and limits that press: the order is theirs
        restore(island);
        takeSubsteps(island, sub, report);
        next = std::min(2 * sub, h);
        took = sub;
      }
      left -= took;
      ++taken;
      continue;
    }
    take(body);
    const double rate =
        rungeKuttaError(*body.rows, body.memory->response.start(), body.vData(), sub, body.stages) /
        sub;
    ok = ok && rate < 1e300;
    if (!ok && least) {  // not for an explicit method
      restore(island);
      takeSubsteps(island, left, report);
      break;
    }
    // The estimate is of fourth order, so that its rate falls with the fourth power of the substep.
    const double growth =
        ok ? kSafety * std::pow(std::max(rate / tolerance, 1e-12), -0.25) : kFailedGrowth;
    next = sub * std::clamp(growth, kSmallestGrowth, kLargestGrowth);
    if (!ok || (rate > tolerance && !least)) {
      restore(island);
      continue;
    }
    report.unresolved += rate > tolerance;
    left -= sub;
    ++taken;
  }
  report.substeps = std::max(report.substeps, taken);
}

}  // namespace ragdoll
