#include "core/relaxation/jakobsen.h"

#include <cmath>

#include "core/contact/constants.h"
#include "core/contact/detect.h"
#include "core/linear/relax.h"
#include "core/linear/stick_solver.h"
#include "core/mechanics/joint_damping.h"
#include "core/relaxation/integrate.h"
#include "core/relaxation/relaxation_guard.h"
#include "ragdoll_sim/core/sleep.h"

namespace ragdoll {
namespace {

void integrate(const StepContext& context, RelaxationWorkspace& ws) {
  const Model& model = context.model;
  const Inputs& inputs = context.inputs;
  const State& state = context.state;
  const double h = context.h;
  ws.x1 = state.x;
  ws.v1 = state.v;
  const double decay = std::exp(-model.solver.damping * h);
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i) {
    if (state.asleep[i]) continue;
    const Ragdoll& r = model.ragdolls[i];
    const System& s = model.systemOf(r);
    const int n = model.skeletonOf(r).size();
    ws.acceleration.noalias() = model.gravity * s.gravity;
    if (context.force) ws.acceleration.noalias() += context.force->middleCols(r.first, n) * s.W;
    auto v = ws.v1.middleCols(r.first, n);
    if (decay != 1) v *= decay;
    if (model.solver.joint_damping > 0)
      dampInnerMotion({*s.direct.rows, ws.energy}, s.pins,
                      std::exp(-model.solver.joint_damping * h), state.x.middleCols(r.first, n), v);
    integrateFree(model.solver.integrator, h, ws.acceleration, ws.x1.middleCols(r.first, n), v);
  }
  for (std::size_t p = 0; p < inputs.pins.size(); ++p) {
    const Pin& pin = model.pins[p];
    const Ragdoll& r = model.ragdolls[pin.ragdoll];
    const System& s = model.systemOf(r);
    const Vec3 move = inputs.pins[p] - state.x.col(pin.particle);
    int row = 0;
    while (s.pins[row] != pin.particle - r.first) ++row;
    const Vec3 speed = move / h;
    ws.x1.middleCols(r.first, s.pin_motion.cols()).noalias() += move * s.pin_motion.row(row);
    ws.v1.middleCols(r.first, s.pin_motion.cols()).noalias() += speed * s.pin_motion.row(row);
  }
}

void constrain(const Model& model, const State& start, RelaxationWorkspace& ws, Points& x) {
  for (int sweep = 0; sweep < model.solver.sweeps; ++sweep) {
    for (std::size_t i = 0; i < model.ragdolls.size(); ++i) {
      if (start.asleep[i]) continue;
      const Ragdoll& r = model.ragdolls[i];
      const System& s = model.systemOf(r);
      const Skeleton& k = model.skeletonOf(r);
      if (s.lumped)
        relaxSticks(s.relaxed, x.data() + 3 * r.first);
      else
        relaxCoupledSticks(s.coupled, s.relaxed_BW, s.relaxed_G, x.middleCols(r.first, k.size()));
    }
    if (!ws.limits.empty()) ws.limits.sweep(model, x);
    ws.projection.sweep(x);
  }
}

/// Gives what is in it its size.
void makeRoom(const Model& model, RelaxationWorkspace& ws) {
  makeRoom(model, ws.removal);
  for (const Ragdoll& r : model.ragdolls) {
    const StickRows& rows = *model.systemOf(r).direct.rows;
    makeRoom(rows, ws.energy);
    ws.moved.resize(3, rows.n);
  }
}

void findAllContacts(const Model& model, const Inputs& inputs, RelaxationWorkspace& ws,
                     const State& state) {
  findContacts(model, state, ws.x1, inputs.obstacles, kNearBody, ws.obstacles, ws.contacts);
  if (model.self_collision)
    for (std::size_t i = 0; i < model.ragdolls.size(); ++i)
      if (!state.asleep[i])
        ws.pairs.appendSelf(model, state.x, ws.x1, static_cast<int>(i),
                            PairSearch::touches(kNearBody), ws.contacts);
  if (model.ragdoll_collision)
    ws.pairs.appendBetween(model, state, state.x, ws.x1, PairSearch::touches(kNearBody),
                           ws.contacts);
}

}  // namespace

void stepJakobsen(const StepContext& context, RelaxationWorkspace& ws, StepReport& report) {
  const Model& model = context.model;
  State& state = context.state;
  const double h = context.h;
  if (ws.x0.cols() != model.size()) makeRoom(model, ws);
  do {
    integrate(context, ws);
    findAllContacts(model, context.inputs, ws, state);
  } while (model.ragdoll_collision && wakeTouched(ws.contacts, ws.x1, state));
  ws.limits.prepare(model, state, ws.x1, h);
  ws.projection.prepare(model, ws.contacts, state.x, ws.x1, ws.v1, h);
  ws.x0 = state.x;
  ws.v0 = state.v;
  state.x = ws.x1;
  constrain(model, state, ws, state.x);
  state.v = ws.v1 + (state.x - ws.x1) / h;
  ws.projection.bounce(h, state.v);
  report.contacts = ws.projection.pressing();
  ws.projection.markPressed(context.supports);
  if (context.guarded) guardRelaxation(context, ws, report);
  limitPairEnergy(context, ws, report);
  keepAllowed(model, state);
}

}  // namespace ragdoll
