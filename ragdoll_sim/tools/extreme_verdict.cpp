#include "extreme_verdict.h"

#include <algorithm>
#include <cmath>

#include "extreme_scenes.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/sleep.h"
#include "ragdoll_sim/core/solver_presets.h"

namespace ragdoll::lab {
namespace {

constexpr double kRestDamping = 2;  ///< [1/s] what the shipped scenes have
constexpr double kAtRest = 1e-6;    ///< of weight times size: less energy than this is rest
constexpr double kOverlap = 1e-3;   ///< [m] deeper than sound steps leave it

double largestSpeed(const State& state) { return state.v.colwise().norm().maxCoeff(); }

double lowestPoint(const Model& model, const State& state) {
  double lowest = kUnbounded;
  for (const Ragdoll& r : model.ragdolls)
    for (int i = r.first; i < r.first + model.skeletonOf(r).named; ++i)
      lowest = std::min(lowest, state.x(2, i));
  return lowest;
}

/// Whether a pinned particle is not where its pin is.
bool isOff(const Model& model, const State& state, const std::vector<Vec3>& pins) {
  constexpr double kOff = 1e-6;  // [m]
  for (std::size_t p = 0; p < pins.size(); ++p)
    if ((state.x.col(model.pins[p].particle) - pins[p]).norm() > kOff) return true;
  return false;
}

/// [J] of falling by the first body's own size, at 10 m/s^2 if there is no gravity.
double fallEnergy(const Model& model) {
  const Skeleton& s = model.skeletonOf(model.ragdolls[0]);
  const double size = (s.rest.rowwise().maxCoeff() - s.rest.rowwise().minCoeff()).norm();
  const double g = model.gravity.norm();
  return s.M.sum() * (g > 0 ? g : 10) * size;
}

/// The laws, watched step by step.
class Watch {
 public:
  Watch(const Extreme& extreme, const Model& model, Verdict& verdict)
      : extreme_(extreme), model_(model), verdict_(verdict) {}

  /// energy [J] less the work of pokes; driven: something moved in the step before.
  void look(const State& state, double time, double energy, bool driven) {
    const double h = model_.solver.step;
    energy -= workOfOverlaps(state, energy);
    least_ = driven ? energy : std::min(least_, energy);
    rise_ = std::max(rise_, energy - least_);
    verdict_.speed = std::max(verdict_.speed, largestSpeed(state));
    kinetic_ = std::max(kinetic_, kineticEnergy(model_, state));
    lowest_ = std::min(lowest_, lowestPoint(model_, state));
    if (time + 0.5 * h >= extreme_.laws.joined) {
      verdict_.stick_error = std::max(verdict_.stick_error, maxStickError(model_, state));
      verdict_.depth = std::max(verdict_.depth, maxPenetration(model_, state));
    }
    const Vec3 centre = centreOfMass(model_, state, 0);
    if (time < 0.5 * extreme_.seconds)
      middle_ = centre;
    else
      verdict_.drift = std::max(verdict_.drift, (centre - middle_).norm());
    const bool still = largestSpeed(state) < kStillSpeed;
    if (!still) verdict_.rest = -1;
    if (still && verdict_.rest < 0) verdict_.rest = time;
  }

  void finish(const Summary& summary) {
    verdict_.guard = summary.guard;
    verdict_.step_time = summary.wall_seconds / std::max(1.0, static_cast<double>(summary.steps));
    const double in_play =
        std::max({kinetic_, std::abs(summary.work), kAtRest * fallEnergy(model_)});
    // Sticks that relaxation stretches hold energy that nobody counts and give it back.
    const bool exact = model_.solver.method != Method::kJakobsen;
    verdict_.energy_rise = (exact ? rise_ : summary.max_energy_rise) / in_play;
    const Laws& laws = extreme_.laws;
    require(summary.finite, "not finite", NAN);
    if (!summary.finite) return;
    require(verdict_.energy_rise <= laws.energy_rise, "energy", verdict_.energy_rise);
    require(verdict_.stick_error <= laws.stick_error, "sticks", verdict_.stick_error);
    const bool told = laws.squeezed && summary.guard.unresolved > 0;
    require(told || verdict_.depth <= laws.depth, "depth", verdict_.depth);
    require(lowest_ >= laws.lowest, "fell through", lowest_);
    require(verdict_.speed <= laws.speed, "speed", verdict_.speed);
    require(verdict_.drift <= laws.drift, "drift", verdict_.drift);
    require(!laws.rest || verdict_.rest >= 0, "no rest", NAN);
  }

 private:
  void require(bool kept, const std::string& law, double figure) {
    if (!kept)
      verdict_.broken.push_back(std::isnan(figure) ? law : law + " " + shortNumber(figure));
  }

  /// [J] by which overlaps that driven obstacles left have lifted bodies as they opened, which
  /// gives no speed: work of what drove them.
  double workOfOverlaps(const State& state, double energy) {
    const double height = energy - kineticEnergy(model_, state);
    if (extreme_.laws.squeezed && overlap_ > kOverlap)
      opened_ += std::clamp(height - height_, 0.0, std::max(0.0, energy - energy_));
    overlap_ = maxPenetration(model_, state);
    energy_ = energy;
    height_ = height;
    return opened_;
  }

  const Extreme& extreme_;
  const Model& model_;
  Verdict& verdict_;
  Vec3 middle_ = Vec3::Zero();  ///< centre of mass after half of the time
  double overlap_ = 0;          ///< [m] at the step's start
  double energy_ = 0;           ///< [J] less the work of pokes, then
  double height_ = 0;           ///< [J] of it without motion
  double opened_ = 0;           ///< [J] workOfOverlaps
  double least_ = kUnbounded;   ///< [J] energy less the work of pokes
  double rise_ = 0;             ///< [J] of it, above the least before
  double kinetic_ = 0;          ///< [J] largest kinetic energy
  double lowest_ = kUnbounded;  ///< [m]
};

}  // namespace

std::vector<ExtremeMethod> extremeMethods() {
  return {{"jakobsen", preset("thesis"), false},
          {"fast", preset("fast"), false},
          {"shake", preset("balanced"), true},
          {"rk", preset("reference"), false}};
}

Verdict judge(const Extreme& extreme, const ExtremeMethod& method) {
  Verdict verdict;
  if ((extreme.sweeps > 0 && method.solver.method != Method::kJakobsen) ||
      (extreme.only_default && !method.is_default)) {
    verdict.tested = false;
    return verdict;
  }
  Scene scene = extreme.scene;
  scene.solver = method.solver;
  scene.solver.sleep = extreme.sleep;
  if (extreme.laws.rest) scene.solver.joint_damping = kRestDamping;
  if (extreme.step > 0) scene.solver.step = extreme.step;
  if (extreme.sweeps > 0) scene.solver.sweeps = extreme.sweeps;
  const Model model = buildModel(scene);
  WatchedRun run(model);
  Watch watch(extreme, model, verdict);
  if (extreme.laws.joined <= 0) watch.look(run.state(), 0, run.summary().energy_end, false);
  const double steps = std::ceil(extreme.seconds / model.solver.step - 1e-9);
  std::vector<Pose> obstacles = run.state().obstacles;
  std::vector<Vec3> pins;
  for (const Pin& pin : model.pins) pins.push_back(pin.target);
  for (double i = 0; i < steps; ++i) {
    // A pin that could not follow still moves when what drove it stands.
    const bool driven = run.time() < extreme.laws.settled || isOff(model, run.state(), pins);
    if (extreme.drive) {
      extreme.drive(run.time() + model.solver.step, obstacles);
      run.moveObstacles(obstacles);
    }
    if (extreme.drive_pins) {
      extreme.drive_pins(run.time() + model.solver.step, pins);
      run.movePins(pins);
    }
    run.step();
    if (!run.state().x.allFinite() || !run.state().v.allFinite()) break;
    watch.look(run.state(), run.time(), run.summary().energy_end - run.summary().work, driven);
  }
  watch.finish(run.summary());
  return verdict;
}

}  // namespace ragdoll::lab
