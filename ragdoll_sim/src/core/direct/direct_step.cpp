#include "core/direct/direct_step.h"

#include <memory>
#include <utility>

#include "core/direct/adaptive_step.h"
#include "core/direct/begin_step.h"
#include "core/direct/motion.h"
#include "core/direct/step_island.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {
namespace {

bool hasTolerance(const StepContext& context) {
  const SolverSpec& solver = context.model.solver;
  return solver.tolerance > 0 && context.guarded && !context.relaxed &&
         (solver.method == Method::kShake || solver.method == Method::kRk);
}

}  // namespace

void makeRoom(const StepContext& context) {
  const Model& model = context.model;
  DirectWorkspace& ws = context.ws;
  ws.bodies.resize(model.ragdolls.size());
  for (std::size_t i = 0; i < ws.bodies.size() && !ws.lends; ++i) {
    if (ws.bodies[i]) continue;
    const Ragdoll& r = model.ragdolls[i];
    ws.bodies[i] = std::make_unique<BodyMemory>();
    makeRoom(model.skeletonOf(r), model.systemOf(r).direct, *ws.bodies[i]);
  }
  const std::size_t threads = threadsOf(context);
  if (ws.scratch.size() < threads) ws.scratch.resize(threads);
  for (WorkerScratch& scratch : ws.scratch) {
    scratch.obstacles.reserve(model.obstacles.size());
    scratch.poses.resize(3, model.size());
    for (IslandScratch* island : {&scratch.island, &scratch.lone}) makeRoom(model, *island);
    if (!ws.lends || scratch.lent.size() == model.skeletons.size()) continue;
    scratch.lent.resize(model.skeletons.size());
    for (const Ragdoll& r : model.ragdolls)
      makeRoom(model.skeletonOf(r), model.systemOf(r).direct, scratch.lent[r.skeleton]);
  }
  ws.obstacles.reserve(model.obstacles.size());
  for (std::vector<CachedImpulse>* impulses : {&ws.impulses, &context.state.impulses})
    impulses->reserve(kRoomForRows * model.ragdolls.size());
  ws.first_multiplier.clear();
  int count = 0;
  for (const Ragdoll& r : model.ragdolls) {
    ws.first_multiplier.push_back(count);
    count += multiplierCount(*model.systemOf(r).direct.rows);
  }
  ws.multipliers = count;
  context.state.multipliers.reserve(count);
}

void prepareDirect(const StepContext& context) {
  const Model& model = context.model;
  DirectWorkspace& ws = context.ws;
  State& state = context.state;
  makeRoom(context);
  if (static_cast<int>(state.multipliers.size()) != ws.multipliers)
    state.multipliers.assign(ws.multipliers, 0.0);
  sweepObstacles(model, state, context.inputs.obstacles, ws.obstacles);
  ws.impulses.clear();
}

void stepBodies(const StepContext& context, const std::vector<int>& bodies,
                const std::vector<int>& sleepers, std::vector<CachedImpulse>& impulses,
                std::vector<BodyPair>& pressing, StepReport& report) {
  Island island(context, scratchOf(context).island);
  if (hasTolerance(context)) {
    stepWithinTolerance(context, bodies, sleepers, report);
  } else {
    bindIsland(island, bodies, sleepers);
    stepIsland(island, report);
  }
  for (const Body* body : island.bodies) {
    const std::vector<CachedImpulse>& own = body->cache.impulses();
    for (const CachedImpulse& impulse : own)
      if (impulse.obstacle >= 0) context.supports.pressed[body->index] = 1;
    context.supports.gripped[body->index] = body->cache.gripped();
    append(own, impulses);
  }
  const std::vector<CachedImpulse>& shared = island.pairs.cache.impulses();
  append(shared, impulses);
  append(island.pairs.pressing, pressing);
  append(island.pairs.met, pressing);
}

void stepApart(const StepContext& context, const std::vector<int>& bodies, StepReport& report) {
  DirectWorkspace& ws = context.ws;
  std::vector<BodyPair>& pressing = context.supports.pressing;
  const int count = static_cast<int>(bodies.size());
  if (count < 2 || threadsOf(context) < 2) {
    for (const int i : bodies) {
      ws.scratch[0].lone_body.assign(1, i);
      stepBodies(context, ws.scratch[0].lone_body, ws.no_bodies, ws.impulses, pressing, report);
    }
    return;
  }
  if (static_cast<int>(ws.outcomes.size()) < count) ws.outcomes.resize(count);
  forEachPart(context, count, [&](StepContext& own, int k) {
    Outcome& outcome = ws.outcomes[k];
    outcome.clear();
    if (own.log) own.log = &outcome.log;
    std::vector<int>& body = scratchOf(own).lone_body;
    body.assign(1, bodies[k]);
    stepBodies(own, body, ws.no_bodies, outcome.impulses, outcome.pressing, outcome.report);
  });
  for (int k = 0; k < count; ++k) {
    append(ws.outcomes[k].impulses, ws.impulses);
    append(ws.outcomes[k].pressing, pressing);
    if (context.log) append(ws.outcomes[k].log.impulses, context.log->impulses);
    report += ws.outcomes[k].report;
  }
}

void keepSleepersImpulses(const StepContext& context, std::vector<CachedImpulse>& impulses) {
  for (const CachedImpulse& impulse : context.state.impulses) {
    const Ragdoll& r = context.model.ragdolls[impulse.ragdoll];
    if (context.state.asleep[impulse.ragdoll] &&
        impulse.other[0] < r.first + context.model.skeletonOf(r).size())
      impulses.push_back(impulse);
  }
}

void predictFreely(const StepContext& context, int ragdoll) {
  IslandScratch& scratch = scratchOf(context).island;
  scratch.ragdolls.assign(1, ragdoll);
  makePlaces(context.model, scratch.ragdolls, scratch);
  Body& body = takePlace(context.model, ragdoll, scratch);
  body.bind(context, ragdoll);
  StepReport ignored;
  beginStep(body, ignored);
  body.memory->response.setStart(body.xData());
  freeMotion(body, context.h);
  body.x() += body.motion.dx;
}

void stepDirect(const StepContext& context, StepReport& report) {
  prepareDirect(context);
  DirectWorkspace& ws = context.ws;
  State& state = context.state;
  if (context.model.ragdoll_collision) {
    ws.builder.step(context, report);
  } else {
    ws.awake.clear();
    for (std::size_t i = 0; i < context.model.ragdolls.size(); ++i)
      if (!state.asleep[i]) ws.awake.push_back(static_cast<int>(i));
    stepApart(context, ws.awake, report);
  }
  keepSleepersImpulses(context, ws.impulses);
  std::swap(state.impulses, ws.impulses);
  keepAllowed(context.model, state);
}

}  // namespace ragdoll
