#include "core/relaxation/relaxation_guard.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/distance.h"
#include "core/direct/constants.h"
#include "core/direct/direct_step.h"
#include "core/mechanics/energy_gain.h"
#include "core/mechanics/energy_removal.h"
#include "core/relaxation/constants.h"

namespace ragdoll {
namespace {

class RelaxationGuard {
 public:
  RelaxationGuard(const StepContext& context, RelaxationWorkspace& ws)
      : model_(context.model),
        inputs_(context.inputs),
        force_(context.force),
        ws_(ws),
        state_(context.state) {}

  /// Whether the sweeps failed on the body.
  bool failed(int i) {
    const Ragdoll& r = model_.ragdolls[i];
    const int n = model_.skeletonOf(r).size();
    const double sum =
        state_.x.middleCols(r.first, n).sum() + state_.v.middleCols(r.first, n).sum();
    return !std::isfinite(sum) || stretched(i) || inside(i) || gained(i);
  }

  /// Whether something that moves from outside may give energy.
  bool driven() const { return !inputs_.pins.empty() || !inputs_.obstacles.empty(); }

  /// [J] by how much the body gained more than gravity and pokes can have given it.
  double rise(int i) {
    const Ragdoll& r = model_.ragdolls[i];
    const StickRows& rows = *model_.systemOf(r).direct.rows;
    Points& moved = ws_.moved;
    moved = state_.x.middleCols(r.first, rows.n) - ws_.x0.middleCols(r.first, rows.n);
    double rise =
        energyGain(rows, ws_.v0.middleCols(r.first, rows.n), state_.v.middleCols(r.first, rows.n),
                   moved, model_.gravity, ws_.energy);
    if (force_) rise -= force_->middleCols(r.first, rows.n).cwiseProduct(moved).sum();
    return rise;
  }

 private:
  bool stretched(int i) const {
    constexpr double kLongest = (1 + kFailed) * (1 + kFailed);
    constexpr double kShortest = (1 - kFailed) * (1 - kFailed);
    const Ragdoll& r = model_.ragdolls[i];
    const System& s = model_.systemOf(r);
    const auto far = [&](int a, int b, double length) {
      const double now = (state_.x.col(r.first + b) - state_.x.col(r.first + a)).squaredNorm();
      return now > kLongest * length * length || now < kShortest * length * length;
    };
    if (s.lumped)
      return std::any_of(s.relaxed.begin(), s.relaxed.end(),
                         [&](const RelaxedStick& k) { return far(k.a, k.b, k.length); });
    for (std::size_t k = 0; k < s.coupled.size(); ++k)
      if (s.relaxed_G[k] > 0 && far(s.coupled[k].a, s.coupled[k].b, s.coupled[k].length))
        return true;
    return false;
  }

  bool deep(const Contact& c) const {
    double radius = std::numeric_limits<double>::infinity();
    for (int k = 0; k < c.count; ++k) radius = std::min(radius, model_.radius[c.particle[k]]);
    return c.gapAt(state_.x) < std::min(-kMostDepth * radius, c.gap_start);
  }

  /// Deep in an obstacle, or beyond one that the sweeps carried it through.
  bool inside(int i) {
    for (const Contact& c : ws_.contacts)
      if (c.ragdoll == i && c.obstacle >= 0 && deep(c)) return true;
    if (model_.obstacles.empty()) return false;
    const Ragdoll& r = model_.ragdolls[i];
    bool beyond = false;  // so far that it may have passed through something
    const double thinnest = thinnestObstacle();
    for (int j = r.first; j < r.first + model_.skeletonOf(r).named; ++j) {
      const double radius = model_.radius[j];
      const double carried2 = (state_.x.col(j) - ws_.x1.col(j)).squaredNorm();
      if (carried2 < kMostDepth * kMostDepth * radius * radius) continue;
      if (insideObstacle(j)) return true;
      beyond = beyond || carried2 > (thinnest + radius) * (thinnest + radius);
    }
    if (!beyond) return false;
    sweepObstacles(model_, state_, inputs_.obstacles, ws_.obstacles);
    ws_.passed.clear();
    appendContacts(model_, ws_.obstacles, ws_.x0, state_.x, i, 0, ws_.passed);
    return std::any_of(ws_.passed.begin(), ws_.passed.end(),
                       [this](const Contact& c) { return deep(c); });
  }

  /// Whether the particle is deep in an obstacle, and deeper than it was.
  bool insideObstacle(int particle) const {
    const double radius = model_.radius[particle];
    for (std::size_t k = 0; k < model_.obstacles.size(); ++k) {
      const Pose& start = state_.obstacles[k];
      const Pose& end = inputs_.obstacles.empty() ? start : inputs_.obstacles[k];
      const auto gap = [&](const Pose& pose, const Vec3& x) {
        const Vec3 local = pose.orientation.conjugate() * (x - pose.position);
        return signedDistanceValue(model_.obstacles[k], local) - radius;
      };
      const double now = gap(end, state_.x.col(particle));
      if (now < -kMostDepth * radius && now < gap(start, ws_.x0.col(particle))) return true;
    }
    return false;
  }

  /// [m] across the thinnest one.
  double thinnestObstacle() const {
    double thinnest = std::numeric_limits<double>::infinity();
    for (const Obstacle& o : model_.obstacles)
      if (o.type == ObstacleSpec::Type::kBox)
        thinnest = std::min(thinnest, 2 * o.half.minCoeff());
      else if (o.type != ObstacleSpec::Type::kPlane)
        thinnest = std::min(thinnest, 2 * o.radius);
    return thinnest;
  }

  /// More energy than the start's and the work: stretched sticks that the sweeps let go.
  bool gained(int i) {
    if (driven() || model_.ragdoll_collision) return false;  // other bodies may give it, too
    const double gain = rise(i);
    const Ragdoll& r = model_.ragdolls[i];
    const StickRows& rows = *model_.systemOf(r).direct.rows;
    if (gain < 0.5 * rows.mass.sum() * kFreeSpeed * kFreeSpeed * rows.scale) return false;
    return !(gain <= kFailed * kineticEnergy(rows, ws_.v0.middleCols(r.first, rows.n), ws_.energy));
  }

  const Model& model_;
  const Inputs& inputs_;
  const Points* force_;
  RelaxationWorkspace& ws_;
  State& state_;
};

/// Of one body's tension, which the guard's last step left behind.
class Tension {
 public:
  Tension(const StepContext& context, int i)
      : rows_(*context.model.systemOf(context.model.ragdolls[i]).direct.rows),
        multipliers_(context.state.multipliers.data() + context.ws.first_multiplier[i],
                     multiplierCount(rows_)) {}

  /// Whether it is still beyond what sweeps can take.
  bool isStiff(double h) const {
    if (rows_.s == 0) return false;
    const auto pulls = multipliers_.head(rows_.s).cwiseAbs();
    double omega2 = 0;
    for (int k = 0; k < rows_.s; ++k)
      omega2 = std::max(omega2, 2 * rows_.absolute_G.row(k).head(rows_.s).dot(pulls));
    return h * std::sqrt(omega2) > kStable;
  }
  void forget() { multipliers_.setZero(); }

 private:
  const StickRows& rows_;
  Eigen::Map<Eigen::VectorXd> multipliers_;
};

/// [N] Pokes, and what others gave a body in the sweeps and got from it: its step alone does not
/// see them, and momentum stays.
const Points* forcesOn(const StepContext& context, int i, RelaxationWorkspace& ws) {
  const auto has = [i](const BodyPair& pair) { return pair.first == i || pair.second == i; };
  const std::vector<BodyPair>& pressing = context.supports.pressing;
  if (std::none_of(pressing.begin(), pressing.end(), has)) return context.force;
  if (context.force)
    ws.force = *context.force;
  else
    ws.force.setZero(3, ws.x0.cols());
  const Ragdoll& r = context.model.ragdolls[i];
  ws.projection.addPairForces(r.first, context.model.skeletonOf(r).size(), context.h, ws.force);
  return ws.force.allFinite() ? &ws.force : context.force;
}

/// The body's step anew, by the direct method's implicit steps.
void stepAnew(const StepContext& context, int i, RelaxationWorkspace& ws, StepReport& report) {
  State& state = context.state;
  const Ragdoll& r = context.model.ragdolls[i];
  const int n = context.model.skeletonOf(r).size();
  state.x.middleCols(r.first, n) = ws.x0.middleCols(r.first, n);
  state.v.middleCols(r.first, n) = ws.v0.middleCols(r.first, n);
  context.supports.pressed[i] = context.supports.gripped[i] = 0;
  const StepContext own{context.model,   context.inputs, context.h, forcesOn(context, i, ws),
                        context.guarded, true,           state,     context.ws,
                        context.supports};
  ws.bodies.assign(1, i);
  stepBodies(own, ws.bodies, {}, context.ws.impulses, context.supports.pressing, report);
}

}  // namespace

void guardRelaxation(const StepContext& context, RelaxationWorkspace& ws, StepReport& report) {
  State& state = context.state;
  RelaxationGuard guard(context, ws);
  context.ws.lends = true;
  makeRoom(context);
  const bool acted = !state.multipliers.empty();  // in the last step
  if (acted) prepareDirect(context);
  bool acts = false;
  for (std::size_t k = 0; k < context.model.ragdolls.size(); ++k) {
    const int i = static_cast<int>(k);
    if (state.asleep[k]) continue;
    if (!(acted && Tension(context, i).isStiff(context.h)) && !guard.failed(i)) {
      if (acted) Tension(context, i).forget();
      continue;
    }
    if (!acted && !acts) prepareDirect(context);
    acts = true;
    stepAnew(context, i, ws, report);
  }
  if (acted && !acts) state.multipliers.clear();
}

void limitPairEnergy(const StepContext& context, RelaxationWorkspace& ws, StepReport& report) {
  const Supports& supports = context.supports;
  if (supports.pressing.empty()) return;
  RelaxationGuard guard(context, ws);
  if (guard.driven()) return;
  std::vector<int>& bodies = ws.bodies;
  bodies.clear();
  bool held = false;
  for (const BodyPair& pair : supports.pressing) {
    for (const int i : {pair.first, pair.second}) {
      held = held || context.state.asleep[i] || supports.pressed[i] ||
             !context.model.systemOf(context.model.ragdolls[i]).pins.empty();
      if (!context.state.asleep[i]) bodies.push_back(i);
    }
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  double rise = 0;
  for (const int i : bodies) rise += guard.rise(i);
  if (!(rise > 0)) return;
  takeEnergyOut(context.model, bodies, held, rise, context.state.x, context.state.v, ws.removal);
  if (rise > kReportedGain) report.limited += static_cast<int>(bodies.size());
}

}  // namespace ragdoll
