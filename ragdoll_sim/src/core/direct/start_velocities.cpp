#include "core/direct/start_velocities.h"

#include <numeric>
#include <vector>

#include "core/direct/begin_step.h"
#include "core/direct/candidates.h"
#include "core/direct/constants.h"
#include "core/direct/direct_step.h"
#include "core/direct/driving.h"
#include "core/direct/velocity_solver.h"
#include "core/direct/workspace.h"
#include "ragdoll_sim/core/measures.h"

namespace ragdoll {
namespace {

/// What touches, whatever the step is. What is farther is met in the first steps.
constexpr Tolerances kAtStart{kContactTolerance, kContactTolerance, kContactTolerance / kLever};
constexpr double kNoFriction = 1e-30;  ///< [-] of pairs, whose contacts are three rows always

void stopPins(Body& body) {
  const std::vector<int>& pins = body.pinned->pins;
  body.kept = body.v();
  addCarried(body, body.kept, -1, body.v());
  for (const int pin : pins) body.v().col(pin).setZero();
}

void settle(Island& island) {
  for (Body* body : island.bodies) {
    makeVelocitiesAffine(*body);
    stopPins(*body);
    body->motion.dx.setZero(3, body->n);
    BodyResponse& response = body->memory->response;
    response.setStart(body->xData());
    response.projectAtStart(body->vData());
  }
  findCandidates(island, island.context.h);
  placeAtStart(island);
  for (Body* body : island.bodies)
    for (Contact& c : body->constraints.contacts) c.friction = 0;
  for (Contact& c : island.pairs.contacts) c.friction = kNoFriction;
  bounce(island, Stage::kStop);
}

}  // namespace

double makeConsistent(const Model& model, State& state) {
  if (state.v.isZero(0)) return 0;
  State settled = state;
  DirectWorkspace ws;
  Supports supports;
  const Inputs none;
  StepContext context{model, none, model.solver.step, nullptr, true, false, settled, ws, supports};
  context.tolerances = kAtStart;
  prepareDirect(context);
  Island island(context, scratchOf(context).island);
  std::vector<int> all(model.ragdolls.size());
  std::iota(all.begin(), all.end(), 0);
  if (model.ragdoll_collision) {
    bindIsland(island, all, {});
    settle(island);
  } else {
    for (const int i : all) {
      bindIsland(island, {i}, {});
      settle(island);
    }
  }
  const double before = kineticEnergy(model, state);
  for (const Ragdoll& r : model.ragdolls) {
    const int n = model.skeletonOf(r).size();
    const auto v = settled.v.middleCols(r.first, n);
    if (!v.allFinite() ||
        (v - state.v.middleCols(r.first, n)).cwiseAbs().maxCoeff() < kContradiction)
      continue;
    state.v.middleCols(r.first, n) = v;
  }
  return before - kineticEnergy(model, state);
}

}  // namespace ragdoll
