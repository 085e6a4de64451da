// Memory of the direct methods, sized by the first step. What it keeps from step to step
// (BodyMemory) saves work only: a step from the same state has the same bits with a fresh
// workspace.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "core/base/workers.h"
#include "core/contact/detect.h"
#include "core/direct/adaptive_scratch.h"
#include "core/direct/body.h"
#include "core/direct/island.h"
#include "core/direct/island_builder.h"
#include "core/direct/outcome.h"

namespace ragdoll {

/// What one thread steps bodies in.
struct WorkerScratch {
  std::vector<BodyMemory> lent;          ///< per skeleton, to bodies that have none of their own
  IslandScratch island, lone;            ///< lone: of bodies that an island gave up
  Points poses;                          ///< [m] 3 x N (posesOf)
  Roomy<int> lone_body;                  ///< an island of one
  std::vector<SweptObstacle> obstacles;  ///< over a part of a step
};

struct DirectWorkspace {
  std::vector<SweptObstacle> obstacles;
  std::vector<std::unique_ptr<BodyMemory>> bodies;  ///< per ragdoll; none where lends
  /// A thread's memory serves whichever body it steps: of a method that steps few of them so.
  bool lends = false;
  std::vector<int> first_multiplier;  ///< per ragdoll: its first in the state
  int multipliers = 0;                ///< of all
  Workers workers;
  /// Per thread; a deque, as what is in use must not move.
  std::deque<WorkerScratch> scratch = std::deque<WorkerScratch>(1);
  IslandBuilder builder;
  AdaptiveScratch adaptive;
  std::vector<CachedImpulse> impulses;  ///< of this step
  std::vector<int> awake, no_bodies;
  std::vector<Outcome> outcomes;  ///< of bodies that several threads step apart
};

/// Of the thread that takes the step.
inline WorkerScratch& scratchOf(const StepContext& context) {
  return context.ws.scratch[context.worker];
}

/// Parts of a step within a tolerance move the obstacles, which all bodies share: one at a time.
inline int threadsOf(const StepContext& context) {
  const SolverSpec& solver = context.model.solver;
  return solver.tolerance > 0 ? 1 : Workers::count(solver.threads);
}

/// part(context, k) for k = 0 ... count - 1, on the solver's threads, each with a context of its
/// own: parts of a step that do not touch each other.
template <class Part>
void forEachPart(const StepContext& context, int count, const Part& part) {
  DirectWorkspace& ws = context.ws;
  const int threads = threadsOf(context);
  ws.workers.run(threads, count, [&](int k, int worker) {
    StepContext own = context;
    own.worker = worker;
    part(own, k);
  });
}

}  // namespace ragdoll
