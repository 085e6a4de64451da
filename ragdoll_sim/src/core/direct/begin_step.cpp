#include "core/direct/begin_step.h"

#include <algorithm>

#include "core/direct/constants.h"
#include "core/direct/driving.h"
#include "core/direct/length_recovery.h"

namespace ragdoll {
namespace {

bool obstaclesMove(const StepContext& step) {
  const std::vector<Pose>& end = step.inputs.obstacles;
  for (std::size_t k = 0; k < end.size(); ++k)
    if (end[k].position != step.state.obstacles[k].position ||
        end[k].orientation.coeffs() != step.state.obstacles[k].orientation.coeffs())
      return true;
  return false;
}

/// Pinned particles move evenly to their targets and carry what is rigid with them.
void movePins(Body& body) {
  const StepContext& step = *body.context;
  const std::vector<int>& pins = body.pinned->pins;
  for (std::size_t p = 0; p < step.inputs.pins.size(); ++p) {
    const Pin& pin = step.model.pins[p];
    if (pin.ragdoll != body.index) continue;
    const auto row = std::find(pins.begin(), pins.end(), pin.particle - body.first) - pins.begin();
    const Vec3 speed = (step.inputs.pins[p] - step.state.x.col(pin.particle)) / step.h;
    body.pin_speed = std::max(body.pin_speed, speed.norm());
    const Vec3 change = speed - step.state.v.col(pin.particle);
    addCarried(body, row, change, body.v());
  }
}

/// Impulses of the last step: the body's own, and between the island's bodies.
void fillCaches(Island& island) {
  const StepContext& step = island.context;
  for (const CachedImpulse& impulse : step.before ? *step.before : step.state.impulses) {
    const int place = island.placeOf(impulse.ragdoll);
    if (place < 0) continue;
    Body& body = *island.bodies[place];
    const bool on_other = impulse.other[0] >= body.first + body.n;
    if (!on_other)
      body.cache.add(impulse);
    else if (!island.isLone())
      island.pairs.cache.add(impulse);
  }
}

}  // namespace

void makeAffine(Body& body) {
  if (body.skeleton->groups.empty()) return;  // then `affine` is the identity
  body.kept.noalias() = body.x() * body.system->affine.transpose();
  body.x() = body.kept;
  makeVelocitiesAffine(body);
}

void makeVelocitiesAffine(Body& body) {
  if (body.skeleton->groups.empty()) return;
  body.kept.noalias() = body.v() * body.system->affine.transpose();
  body.v() = body.kept;
}

void beginStep(Body& body, StepReport& report) {
  const StepContext& step = *body.context;
  if (step.state.step % kAffineEvery == 0 || step.relaxed) makeAffine(body);
  // The relaxation's guard takes implicit steps, of first order as its own.
  if (step.relaxed) damp(body, step.h);
  movePins(body);  // what moves them is not damped
  body.driven = body.pin_speed > 0 || obstaclesMove(step);
  report.joining += restoreLengths(body, step.h);
  startDriving(body);
}

void beginStep(Island& island, StepReport& report) {
  const SolverSpec& solver = island.context.model.solver;
  const bool damps = solver.damping > 0 || solver.joint_damping > 0;
  for (Body* body : island.bodies) {
    body->damps_within = damps && !island.context.relaxed;
    beginStep(*body, report);
  }
  fillCaches(island);
}

}  // namespace ragdoll
