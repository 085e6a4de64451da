#include "core/direct/driving.h"

#include <algorithm>
#include <cmath>

#include "core/mechanics/energy_gain.h"
#include "core/mechanics/joint_damping.h"

namespace ragdoll {
namespace {

/// Whether a poke acts on the body in this step, off its own point.
bool isPushed(const Body& body) {
  const StepContext& step = *body.context;
  return std::any_of(step.inputs.pokes.begin(), step.inputs.pokes.end(), [&](const Poke& poke) {
    return poke.body.ragdoll == body.index && poke.body.particles.size() > 1 &&
           !poke.point.isZero(0) && isActive(poke, step.state.time, step.wholeStep());
  });
}

void accelerate(Body& body) {
  body.acceleration.noalias() = body.context->model.gravity * body.system->gravity;
  if (body.context->force) body.acceleration.noalias() += body.force * body.system->W;
}

/// [J] of kinetic energy since velocities were `before`, as (v - before) M (v + before) / 2.
double energySince(Body& body, const Points& before) {
  body.energy.change = body.v() - before;
  const auto pushed = momentum(*body.rows, body.energy);
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < body.n; ++i)
    sum += Vec3(pushed.col(i)).cwiseProduct(Vec3(body.v().col(i) + before.col(i)));
  return 0.5 * sum.sum();
}

}  // namespace

void startDriving(Body& body) {
  const StepContext& step = *body.context;
  if (step.force) body.force = step.force->middleCols(body.first, body.n);
  // The relaxation's guard adds what others press with: its forces are those of the start.
  body.pushed = step.force && !step.relaxed && isPushed(body);
  accelerate(body);
  if (step.whole > 0) driveAt(body, body.xData());  // the force is that of the whole step's start
}

bool isPoked(const Body& body) {
  const Points* force = body.context->force;
  return force && !force->middleCols(body.first, body.n).isZero(0);
}

void driveAt(Body& body, const double* x) {
  if (!body.pushed) return;
  const StepContext& step = *body.context;
  const Eigen::Map<const Points> pose(x, 3, body.n);
  body.force.setZero();
  for (const Poke& poke : step.inputs.pokes)
    if (poke.body.ragdoll == body.index && isActive(poke, step.state.time, step.wholeStep()))
      addForce(poke, pose, body.first, body.force);
  accelerate(body);
}

double drive(Body& body, const double* x, const double* v, Points& free) {
  driveAt(body, x);
  free = body.acceleration;
  const Eigen::Map<const Points> pose(x, 3, body.n), velocity(v, 3, body.n);
  double power = body.pushed ? body.force.cwiseProduct(velocity).sum() : 0;
  if (!body.damps_within) return power;
  const SolverSpec& solver = body.context->model.solver;
  const std::vector<int>& pins = body.pinned->pins;
  Points& decay = body.kept;
  decay = solver.damping * velocity;
  if (solver.joint_damping > 0) {
    const RigidMotion rigid = rigidMotion(massOf(body), pins, pose, velocity);
    for (int i = 0; i < body.n; ++i)
      decay.col(i) += solver.joint_damping * (velocity.col(i) - rigid.velocityAt(pose.col(i)));
  }
  Points& held = body.moved;
  held = decay;
  addCarried(body, held, -1, decay);
  free -= decay;
  power -= velocity.lazyProduct(body.skeleton->M).cwiseProduct(decay).sum();
  return power;
}

void addWork(Body& body, double part) {
  if (body.pushed) body.given += part * body.force.cwiseProduct(body.motion.dx).sum();
}

void addCarried(const Body& body, std::size_t p, const Vec3& velocity, Eigen::Ref<Points> v) {
  v.noalias() += velocity * body.system->pin_motion.row(static_cast<Eigen::Index>(p));
}

void addCarried(const Body& body, const Points& of, double share, Eigen::Ref<Points> v) {
  const std::vector<int>& pins = body.pinned->pins;
  for (std::size_t p = 0; p < pins.size(); ++p) addCarried(body, p, share * of.col(pins[p]), v);
}

void restorePins(Body& body, const Points& before) {
  const std::vector<int>& pins = body.pinned->pins;
  for (std::size_t p = 0; p < pins.size(); ++p) {
    const Vec3 lost = before.col(pins[p]) - body.v().col(pins[p]);
    if (!lost.isZero(0)) addCarried(body, p, lost, body.v());
  }
}

void damp(Body& body, double time) {
  const SolverSpec& solver = body.context->model.solver;
  if (!(solver.damping > 0 || solver.joint_damping > 0)) return;
  const std::vector<int>& pins = body.pinned->pins;
  body.kept = body.v();
  if (solver.damping > 0) body.v() *= std::exp(-solver.damping * time);
  if (solver.joint_damping > 0)
    dampInnerMotion(massOf(body), pins, std::exp(-solver.joint_damping * time), body.x(), body.v());
  restorePins(body, body.kept);
  if (body.damps_within) body.damped += energySince(body, body.kept);
}

void dampWithin(Island& island, double time) {
  for (Body* body : island.bodies)
    if (body->damps_within) damp(*body, time);
}

}  // namespace ragdoll
