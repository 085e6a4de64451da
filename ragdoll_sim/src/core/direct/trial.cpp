#include "core/direct/trial.h"

#include <algorithm>

#include "core/direct/angular_momentum.h"
#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/driving.h"
#include "core/direct/edges.h"
#include "core/direct/energy.h"
#include "core/direct/impact.h"
#include "core/direct/implicit.h"
#include "core/direct/motion.h"
#include "core/direct/position_solver.h"
#include "core/direct/rigid_fallback.h"
#include "core/direct/slip_turns.h"
#include "core/direct/smooth_motion.h"
#include "core/direct/step_island.h"
#include "core/direct/velocity_solver.h"
#include "core/direct/workspace.h"

namespace ragdoll {
namespace {

using Way = SubstepControl::Way;

bool isFinite(const Island& island) {
  return std::all_of(island.bodies.begin(), island.bodies.end(), [](const Body* body) {
    const Eigen::Map<const Eigen::ArrayXd> x(body->xData(), 3 * body->n),
        v(body->vData(), 3 * body->n);
    return (0 * x + 0 * v).sum() == 0;  // NaN of what is not finite
  });
}

bool freeMotions(Island& island, double h) {
  bool whole = true;
  for (Body* body : island.bodies) whole = freeMotion(*body, h) && whole;
  return whole;
}

/// The positions at `time` of motions over h that end there. Whether they were found.
bool cutShort(Island& island, double time, double h, Trial& trial) {
  const bool whole = freeMotions(island, time);
  findContactsAnew(island, time, h);
  limitDepenetration(island, time, h);
  return whole && solvePositions(island, time, trial.contacts);
}

/// Moves to what is reached first and takes its impact. What a motion over h tells of its time may
/// leave it open: what else is hit then would not count it as touching.
Trial moveToImpact(Island& island, const Impact& impact, double h) {
  takeImpact(island, impact);
  Trial trial{impact.time};
  if (!(impact.time > 0)) {
    placeAtStart(island);
    dampWithin(island, -0.5 * h);
    restoreAfterImpact(island, bounce(island), h);
    return trial;
  }
  double time = impact.time;
  trial.ok = cutShort(island, time, h, trial);
  for (int i = 0; i < kRefinements && trial.ok; ++i) {
    const double again = std::clamp(impactAgain(island, time), kSnap * h, h);
    if (again == time) break;
    time = again;
    trial.ok = cutShort(island, time, h, trial);
  }
  if (!trial.ok) return trial;
  trial.took = time;
  const VelocitySolution solution =
      finishMotion(island, time, true, Stage::kImpact, trial.took - 0.5 * h);
  trial.defect = solution.defect;
  restoreAfterImpact(island, solution, h);
  return trial;
}

/// Moves to where what touches goes over an edge.
Trial moveToEdge(Island& island, double edge, double h) {
  takeEdge(island);
  Trial trial{edge};
  trial.ok = cutShort(island, edge, h, trial);
  for (int i = 0; i < kRefinements && trial.ok; ++i) {
    const double tip = timeOfTip(island, trial.took);
    if (tip > trial.took) break;
    trial.took = std::max(tip, kSnap * h);
    trial.ok = cutShort(island, trial.took, h, trial);
  }
  const double took = trial.took;
  if (trial.ok)
    trial.defect = finishMotion(island, took, true, Stage::kMotion, took - 0.5 * h).defect;
  return trial;
}

/// SHAKE and RATTLE over h, or to the first impact or edge.
Trial leapfrog(Island& island, double h) {
  Trial trial{h};
  dampWithin(island, 0.5 * h);
  for (Body* body : island.bodies) body->memory->response.setStart(body->xData());
  const bool whole = freeMotions(island, h);
  findCandidates(island, h);
  if (!whole) return {h, false};
  findComing(island, h);
  if (!solvePositions(island, h, trial.contacts)) return {h, false};
  const Impact impact = firstImpact(island, h);
  const double edge = timeOfEdge(island, h);
  if (edge < std::min(impact.time, h)) return moveToEdge(island, edge, h);
  if (impact.time <= h) return moveToImpact(island, impact, h);
  const VelocitySolution solution = finishMotion(island, h, true, Stage::kMotion, 0.5 * h);
  trial.defect = solution.defect;
  const double turn = timeOfTurn(island, solution, h);
  if (turn < h) trial.turn = turn;
  return trial;
}

/// What is left of an implicit step for the next explicit one.
void keepTension(Island& island, double h) {
  for (Body* body : island.bodies) {
    double* m = body->multipliers();
    const int s = body->rows->s;
    for (int k = 0; k < s; ++k) m[k] = m[k + s] = body->motion.lambda[k] / (h * h);
  }
}

/// Backward Euler over h.
Trial implicitTrial(Island& island, double h, StepReport& report) {
  bool found = true;
  for (Body* body : island.bodies) {
    ++report.implicit;
    body->cache.clear();
    body->total.resize(0);
    found = solveImplicitMotion(*body, h) && found;
  }
  island.s.total.resize(0);
  island.pairs.cache.clear();
  if (!found) return {h, false};
  findCandidates(island, h);
  if (!solvePositionsImplicitly(island, h)) return {h, false};
  finishMotion(island, h, false, Stage::kMotion, 0);
  keepTension(island, h);
  return {h, isFinite(island)};
}

/// Where all else fails: each body by itself, as if the others were not there. Whether energy was
/// taken out of one.
bool stepEachAlone(Island& island, double h, StepReport& report) {
  island.pairs.cache.clear();
  island.pairs.touching.clear();
  bool limited = false;
  for (Body* body : island.bodies) {
    Island alone(island.context, scratchOf(island.context).lone);
    bindLone(alone, *body);
    limited = takeSubsteps(alone, h, report) || limited;
  }
  ++report.unresolved;
  return limited;
}

}  // namespace

Trial takeExplicitTrial(Island& island, double h) {
  Trial trial;
  bool leapfrogs = true;
  const SolverSpec& solver = island.context.model.solver;
  if (solver.method == Method::kRk && (island.isLone() || island.context.events)) {
    const SmoothTrial smooth = island.isLone() ? moveSmoothly(island, h) : moveTogether(island, h);
    trial = {smooth.took, smooth.ok, smooth.contacts, smooth.exact};
    trial.defect = smooth.error / kOfDefect;
    leapfrogs = smooth.is_left;
  }
  if (leapfrogs) {
    trial = leapfrog(island, h);
    trial.handed_over = island.context.events;
  }
  trial.ok = trial.ok && isFinite(island);
  return trial;
}

Trial takeTrial(Island& island, const SubstepControl& control, StepReport& report) {
  Trial trial{control.substep()};
  switch (control.way()) {
    case Way::kExplicit:
      return takeExplicitTrial(island, control.substep());
    case Way::kImplicit:
      dampWithin(island, control.substep());
      trial = implicitTrial(island, control.substep(), report);
      break;
    case Way::kRigid:
      dampWithin(island, control.substep());
      trial.limited = moveRigidly(island, control.substep(), report);
      break;
    case Way::kAlone:
      trial.took = control.left();
      trial.limited = stepEachAlone(island, control.left(), report);
  }
  trial.defect = kUnknownRate;
  return trial;
}

}  // namespace ragdoll
