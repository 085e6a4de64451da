#include "ragdoll_sim/core/step.h"

#include "core/direct/shake.h"
#include "core/fast/fast.h"
#include "core/relaxation/jakobsen.h"
#include "core/step/workspace.h"
#include "ragdoll_sim/core/sleep.h"

namespace ragdoll {

Workspace::Workspace() : impl_(std::make_unique<Impl>()) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

void Workspace::setGuard(bool on) { impl_->unguarded = !on; }

namespace {

void gatherForces(const Inputs& inputs, double h, Workspace::Impl& ws, const State& state) {
  ws.forced = false;
  for (const Poke& poke : inputs.pokes) {
    if (!isActive(poke, state.time, h)) continue;
    if (!ws.forced) ws.force.setZero(3, state.x.cols());
    ws.forced = true;
    addForce(poke, state, ws.force);
  }
}

}  // namespace

StepReport step(const Model& model, const Inputs& inputs, Workspace& workspace, State& state) {
  Workspace::Impl& ws = workspace.impl();
  const double h = model.solver.step;
  StepReport report;
  wakeDisturbed(model, inputs, h, state);
  gatherForces(inputs, h, ws, state);
  ws.pressed.assign(model.ragdolls.size(), 0);
  ws.pressing.clear();
  if (model.solver.method == Method::kJakobsen)
    stepJakobsen(model, inputs, h, ws, state, report);
  else if (model.solver.method == Method::kFast)
    stepFast(model, inputs, h, ws, state, report);
  else
    stepShake(model, inputs, h, ws, state, report);
  if (model.solver.sleep) putToSleep(model, ws.pressing, h, ws.pressed, state);
  if (!inputs.obstacles.empty()) state.obstacles = inputs.obstacles;
  ++state.step;
  state.time += h;
  return report;
}

}  // namespace ragdoll
