#include "core/fast/fast.h"

#include <algorithm>

#include "core/direct/direct_step.h"
#include "core/fast/batches.h"
#include "core/fast/island_run.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {
namespace fast {
namespace {

void press(const CachedImpulse& impulse, Supports& supports) {
  if (impulse.obstacle >= 0) supports.pressed[impulse.ragdoll] = 1;
}

/// Of bodies that touch each other, for the islands of the direct method.
class PackStepper : public Stepper {
 public:
  explicit PackStepper(FastScratch& scratch) : s_(scratch) {}

  void stepApart(const StepContext& context, const std::vector<int>& bodies,
                 std::vector<Outcome*>& outcomes, std::vector<int>& left) override {
    stepBatches(context, bodies, s_, left);
    forBatches(s_, [&](const Batch& batch) {
      for (const CachedImpulse& impulse : batch.impulses) {
        Outcome& outcome = *outcomes[impulse.ragdoll];
        outcome.impulses.push_back(impulse);
        if (impulse.obstacle >= 0) ++outcome.report.contacts;
        press(impulse, context.supports);
      }
      for (const int i : batch.limited) ++outcomes[i]->report.limited;
    });
  }

  bool stepTogether(const StepContext& context, const std::vector<int>& bodies,
                    const std::vector<int>& sleepers, Outcome& outcome) override {
    if (!stepIsland(context, s_, *s_.islands[context.worker], bodies, sleepers, outcome))
      return false;
    for (const CachedImpulse& impulse : outcome.impulses) press(impulse, context.supports);
    return true;
  }

  double overlap() const override { return kTouchOverlap; }

 private:
  FastScratch& s_;
};

void makeIslandRooms(const StepContext& context, FastScratch& s) {
  if (!context.model.ragdoll_collision && !context.model.self_collision) return;
  while (static_cast<int>(s.islands.size()) < Workers::count(context.model.solver.threads)) {
    s.islands.push_back(std::make_shared<IslandRoom>());
    makeRoom(context, s, *s.islands.back());
  }
}

/// What packs have left, one by one: as islands of one where a body may touch itself, else by the
/// direct method.
void stepLeft(const StepContext& context, FastScratch& s, StepReport& report) {
  if (context.model.self_collision) {
    std::vector<Outcome>& outcomes = context.ws.outcomes;
    if (outcomes.size() < s.left.size()) outcomes.resize(s.left.size());
    PackStepper stepper(s);
    forEachPart(context, static_cast<int>(s.left.size()), [&](StepContext& own, int k) {
      Outcome& outcome = outcomes[k];
      outcome.clear();
      Roomy<int>& alone = s.islands[own.worker]->alone;
      alone.assign(1, s.left[k]);
      if (stepper.stepTogether(own, alone, own.ws.no_bodies, outcome)) s.left[k] = -1;
    });
    std::size_t kept = 0;
    for (std::size_t k = 0; k < s.left.size(); ++k) {
      append(outcomes[k].impulses, context.ws.impulses);
      report += outcomes[k].report;
      if (s.left[k] >= 0) s.left[kept++] = s.left[k];
    }
    s.left.resize(kept);
  }
  stepApart(context, s.left, report);
}

/// Bodies that do not see each other.
void stepAllApart(const StepContext& context, FastScratch& s, StepReport& report) {
  const State& state = context.state;
  std::vector<int>& awake = context.ws.awake;
  awake.clear();
  for (std::size_t i = 0; i < state.asleep.size(); ++i)
    if (!state.asleep[i]) awake.push_back(static_cast<int>(i));
  s.left.clear();
  s.left.reserve(context.model.ragdolls.size());
  stepBatches(context, awake, s, s.left);
  forBatches(s, [&](const Batch& batch) {
    append(batch.impulses, context.ws.impulses);
    report.contacts += batch.contacts;
    report.limited += static_cast<int>(batch.limited.size());
  });
  for (const CachedImpulse& impulse : context.ws.impulses) press(impulse, context.supports);
  stepLeft(context, s, report);
}

/// Bodies that may touch each other.
void stepAllTogether(const StepContext& context, FastScratch& s, StepReport& report) {
  PackStepper stepper(s);
  context.ws.builder.step(context, report, &stepper);
  s.left.clear();
  for (std::size_t i = 0; i < context.model.ragdolls.size(); ++i)
    if (!context.state.asleep[i] && context.ws.builder.tookDirectly(static_cast<int>(i)))
      s.left.push_back(static_cast<int>(i));
}

}  // namespace
}  // namespace fast

void stepFast(const StepContext& context, FastScratch& s, StepReport& report) {
  const Model& model = context.model;
  State& state = context.state;
  s.packed = !model.compliant;
  context.ws.lends = s.packed && !model.ragdoll_collision;
  if (!s.packed) {
    report.fast_fallbacks =
        static_cast<int>(std::count(state.asleep.begin(), state.asleep.end(), std::uint8_t(0)));
    return stepDirect(context, report);
  }
  prepareDirect(context);
  fast::prepare(context, s);
  fast::makeIslandRooms(context, s);
  if (model.ragdoll_collision)
    fast::stepAllTogether(context, s, report);
  else
    fast::stepAllApart(context, s, report);
  std::fill(state.multipliers.begin(), state.multipliers.end(), 0.0);  // of another method's step
  report.fast_fallbacks = static_cast<int>(s.left.size());
  keepSleepersImpulses(context, context.ws.impulses);
  std::swap(state.impulses, context.ws.impulses);
  keepAllowed(model, state);
}

}  // namespace ragdoll
