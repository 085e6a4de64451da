#include "ragdoll_sim/core/contact_log.h"
#include "ragdoll_sim/core/step.h"

#include "core/direct/direct_step.h"
#include "core/fast/fast.h"
#include "core/relaxation/jakobsen.h"
#include "core/step/workspace.h"
#include "ragdoll_sim/core/sleep.h"

namespace ragdoll {

Workspace::Workspace() : impl_(std::make_unique<Impl>()) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

void Workspace::keepContacts(ContactLog* log) { impl_->log = log; }

void Workspace::setGuard(bool on) { impl_->guarded = on; }

namespace {

/// [N] of the pokes that act in this step; null: none.
const Points* gatherForces(const Inputs& inputs, double h, const State& state, Points& force) {
  bool any = false;
  force.resize(3, state.x.cols());
  for (const Poke& poke : inputs.pokes) {
    if (!isActive(poke, state.time, h)) continue;
    if (!any) force.setZero();
    any = true;
    addForce(poke, state, force);
  }
  return any ? &force : nullptr;
}

/// Relaxation and packs keep no account of what contacts gave.
bool hasNoLog(Method method) { return method == Method::kJakobsen || method == Method::kFast; }

/// What presses of the bodies that a method without a log has moved.
void logPressing(const Model& model, const State& state, Workspace::Impl& ws) {
  const bool fast = model.solver.method == Method::kFast;
  if (fast && !ws.fast.packed) return;
  if (!fast) ws.log->impulses.clear();  // its guard's steps
  ws.unlogged.resize(model.ragdolls.size());
  for (std::size_t i = 0; i < ws.unlogged.size(); ++i) ws.unlogged[i] = !state.asleep[i];
  if (fast)
    for (const int i : ws.fast.left) ws.unlogged[i] = 0;
  appendPressing(model, state, ws.unlogged, ws.log->impulses, &ws.before);
}

}  // namespace

StepReport step(const Model& model, const Inputs& inputs, Workspace& workspace, State& state) {
  Workspace::Impl& ws = workspace.impl();
  const double h = model.solver.step;
  StepReport report;
  wakeDisturbed(model, inputs, h, state);
  ws.supports.pressed.assign(model.ragdolls.size(), 0);
  ws.supports.pressing.clear();
  ws.supports.gripped.assign(model.ragdolls.size(), 0);
  const bool relaxed = model.solver.method == Method::kJakobsen;
  if (ws.log) ws.log->impulses.clear();
  if (ws.log && hasNoLog(model.solver.method)) {
    ws.before.v = state.v;
    ws.before.impulses = state.impulses;
  }
  const StepContext context{model,      inputs,  h,     gatherForces(inputs, h, state, ws.force),
                            ws.guarded, relaxed, state, ws.direct,
                            ws.supports, ws.log};
  if (relaxed)
    stepJakobsen(context, ws.relaxation, report);
  else if (model.solver.method == Method::kFast)
    stepFast(context, ws.fast, report);
  else
    stepDirect(context, report);
  if (ws.log && hasNoLog(model.solver.method)) logPressing(model, state, ws);
  if (model.solver.sleep) putToSleep(model, h, ws.supports, state);
  if (!inputs.obstacles.empty()) state.obstacles = inputs.obstacles;
  ++state.step;
  state.time += h;
  return report;
}

}  // namespace ragdoll
