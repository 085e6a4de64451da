#include "core/direct/shake.h"

#include <algorithm>
#include <cmath>

#include "core/direct/shake_step.h"
#include "core/mechanics/joint_damping.h"

namespace ragdoll {
namespace {

constexpr int kAffineEvery = 256;      ///< [steps] rigid groups are put back into affine shape
constexpr double kCoarse = 1.0 / 120;  ///< [s] steps for which tolerances are made
constexpr double kFinest = 1e-3;       ///< as small as tolerances get, by those

}  // namespace

ShakeStep::ShakeStep(const Model& model, Workspace::Impl& ws, ShakeScratch& scratch, State& state,
                     int ragdoll, StepReport& report)
    : model_(model),
      ws_(ws),
      scratch_(scratch),
      state_(state),
      report_(report),
      index_(ragdoll),
      ragdoll_(model.ragdolls[ragdoll]),
      system_(model.systemOf(ragdoll_).direct),
      rows_(*system_.rows),
      body_(ws.bodies[ragdoll]),
      n_(rows_.n),
      inverse_length2_(rows_.inverse_length2.data()),
      length2_(rows_.length2.data()) {
  body_.start.resize(rows_);
  body_.end.resize(rows_);
}

void ShakeStep::setStep(double h) {
  step_ = h;
  const double share = std::clamp(h * h / (kCoarse * kCoarse), kFinest, 1.0);
  contact_tolerance_ = share * kContactTolerance;
  touching_ = share * kTouching;
  touching_angle_ = share * kTouchingAngle;
}

void ShakeStep::run(const Inputs& inputs, double h) {
  begin(inputs, h);
  if (model_.solver.method == Method::kRk && model_.solver.tolerance > 0)
    adapt(h);
  else
    guard(h);
  end();
}

void ShakeStep::predict(const Inputs& inputs, double h) {
  begin(inputs, h);
  body_.start.setPose(rows_, xData());
  freeMotion(h);
  x() += scratch_.dx;
}

void ShakeStep::begin(const Inputs& inputs, double h) {
  setStep(h);
  if (state_.step % kAffineEvery == 0 || model_.solver.method == Method::kJakobsen) makeAffine();
  if (model_.solver.damping > 0) v() *= std::exp(-model_.solver.damping * h);
  if (model_.solver.joint_damping > 0)
    dampInnerMotion(model_.skeletonOf(ragdoll_).M, model_.systemOf(ragdoll_).pins,
                    std::exp(-model_.solver.joint_damping * h), x(), v());
  movePins(inputs, h);  // what moves them is not damped
  driven_ = pin_speed_ > 0 || obstaclesMove(inputs);
  join(h);
  scratch_.acceleration.noalias() = model_.gravity * system_.gravity;
  if (ws_.forced)
    scratch_.acceleration.noalias() += ws_.force.middleCols(ragdoll_.first, n_) * system_.W;
  scratch_.touching.clear();
  scratch_.touching_limits.clear();
  scratch_.presses.clear();
  for (const Press& last : state_.presses)
    if (last.ragdoll == index_ && last.other[0] < ragdoll_.first + n_)  // not on another body
      scratch_.presses.push_back(last);
}

void ShakeStep::end() {
  for (const Press& press : scratch_.presses)
    if (press.obstacle >= 0) ws_.pressed[index_] = 1;
  ws_.presses.insert(ws_.presses.end(), scratch_.presses.begin(), scratch_.presses.end());
}

void ShakeStep::makeAffine() {
  if (model_.skeletonOf(ragdoll_).groups.empty()) return;  // then `affine` is the identity
  x() = (x() * system_.affine.transpose()).eval();
  v() = (v() * system_.affine.transpose()).eval();
}

bool ShakeStep::obstaclesMove(const Inputs& inputs) const {
  for (std::size_t k = 0; k < inputs.obstacles.size(); ++k)
    if (inputs.obstacles[k].position != state_.obstacles[k].position ||
        inputs.obstacles[k].orientation.coeffs() != state_.obstacles[k].orientation.coeffs())
      return true;
  return false;
}

void ShakeStep::movePins(const Inputs& inputs, double h) {
  if (inputs.pins.empty()) return;
  const std::vector<int>& pins = model_.systemOf(ragdoll_).pins;
  for (std::size_t p = 0; p < inputs.pins.size(); ++p) {
    const Pin& pin = model_.pins[p];
    if (pin.ragdoll != index_) continue;
    const auto row =
        std::find(pins.begin(), pins.end(), pin.particle - ragdoll_.first) - pins.begin();
    const Vec3 speed = (inputs.pins[p] - state_.x.col(pin.particle)) / h;
    pin_speed_ = std::max(pin_speed_, speed.norm());
    v() += (speed - state_.v.col(pin.particle)) * system_.pin_motion.row(row);
  }
}

void stepBodyShake(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws,
                   State& state, int ragdoll, StepReport& report) {
  ShakeStep(model, ws, ws.shake, state, ragdoll, report).run(inputs, h);
}

void prepareShake(const Model& model, const Inputs& inputs, Workspace::Impl& ws, State& state) {
  ws.bodies.resize(model.ragdolls.size());
  ws.first_stick.clear();
  int sticks = 0;
  for (const Ragdoll& r : model.ragdolls) {
    ws.first_stick.push_back(sticks);
    sticks += multiplierCount(*model.systemOf(r).direct.rows);
  }
  if (static_cast<int>(state.multipliers.size()) != sticks) state.multipliers.assign(sticks, 0.0);
  ws.x1.resize(3, model.size());
  sweepObstacles(model, state, inputs.obstacles, ws.obstacles);
  ws.presses.clear();
}

void stepShake(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws,
               State& state, StepReport& report) {
  prepareShake(model, inputs, ws, state);
  if (model.ragdoll_collision)
    stepTogether(model, inputs, h, ws, state, report);
  else
    for (std::size_t i = 0; i < model.ragdolls.size(); ++i)
      if (!state.asleep[i]) stepBodyShake(model, inputs, h, ws, state, static_cast<int>(i), report);
  for (const Press& press : state.presses) {
    const Ragdoll& r = model.ragdolls[press.ragdoll];
    if (state.asleep[press.ragdoll] && press.other[0] < r.first + model.skeletonOf(r).size())
      ws.presses.push_back(press);
  }
  std::swap(state.presses, ws.presses);
  keepAllowed(model, state);
}

}  // namespace ragdoll
