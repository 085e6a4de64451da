#include "survey.h"

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/number_text.h"
#include "ragdoll_sim/core/solver_presets.h"

namespace ragdoll::lab {
namespace {

constexpr double kReferenceShare = 0.2;  ///< of the progress bar
constexpr double kAccuracyShare = 0.3;
constexpr double kFinestForPokes = 480;  ///< [Hz] where no longer steps fit the pokes
constexpr double kWholeStep = 1e-6;      ///< of a step: nearer to a whole number is one
constexpr double kLongest = 1000;  ///< [s] of simulation, in the reference's small steps

/// Whether the scene's pokes begin and end with steps.
bool fitsPokes(const Model& model, double step) {
  const auto isWhole = [step](double time) {
    return time <= 0 || std::abs(std::remainder(time, step)) < kWholeStep * step;
  };
  return std::all_of(model.pokes.begin(), model.pokes.end(), [&](const Poke& poke) {
    return isWhole(poke.start) && isWhole(poke.duration);
  });
}

/// [Hz] The family's longest steps; within a tolerance those that fit the pokes: that they are
/// rounded to steps is an error that none controls.
double coarsestOf(const Family& family, const Model& model) {
  double rate = family.coarsest;
  if (family.solver.tolerance > 0)
    while (rate < kFinestForPokes && !fitsPokes(model, 1 / rate)) rate *= 2;
  return rate;
}

/// Steps that differ by factors of two and end where the window does.
std::vector<Configuration> grid(const Family& family, double window, const Model& model) {
  std::vector<Configuration> result;
  const double coarsest = coarsestOf(family, model), finest = std::max(coarsest, family.finest);
  for (double rate = coarsest; rate <= finest * 1.001; rate *= 2) {
    if (stepsIn(window, 1 / rate) == 0) continue;
    result.push_back({family.name, false, damped(at(family, rate), model.solver)});
  }
  return result;
}

}  // namespace

SurveyOptions completed(const Model& model, SurveyOptions options) {
  const bool contact = hasContact(model);
  if (options.horizon > kLongest)
    throw Error("--horizon", "is " + numberText(options.horizon) + " s; at most " +
                                 numberText(kLongest) + " are possible");
  if (options.horizon == 0) options.horizon = contact ? 2 : 1;
  if (options.window == 0)
    options.window = contact ? std::min(0.1, options.horizon) : options.horizon;
  if (stepsIn(options.horizon, options.window) == 0)
    throw Error("--window", std::to_string(options.window) + " s does not divide the horizon of " +
                                std::to_string(options.horizon) + " s");
  if (stepsIn(options.window, 1.0 / 60) == 0)
    throw Error(options.window == options.horizon ? "--horizon" : "--window",
                std::to_string(options.window) +
                    " s is not a whole number of steps of 1/60 s, at which preset thesis runs");
  return options;
}

Survey survey(const Model& model, const SurveyOptions& options, Progress& progress) {
  Survey result;
  result.horizon = options.horizon;
  result.reference = makeReference(model, options.horizon, options.window, [&](double share) {
    progress.show(kReferenceShare * share, "converging the reference");
  });

  const std::vector<Family> all = families(options.integrators);
  double done = 0;
  for (const Family& family : all) {
    for (const Configuration& c : grid(family, options.window, model)) {
      progress.show(kReferenceShare + kAccuracyShare * done / static_cast<double>(all.size()),
                    family.name);
      const double begin = cpuTime();
      result.rows.push_back(measureAccuracy(model, c, result.reference, options.horizon));
      // Two runs, one of them watched: half is a fair guess of what the next step will cost.
      if (0.5 * (cpuTime() - begin) / options.horizon > 0.5 * options.dearest) break;
    }
    ++done;
  }
  if (options.presets)
    for (const std::string& name : presetNames()) {
      const Configuration c = {name, true, damped(preset(name), model.solver)};
      if (stepsIn(options.window, c.solver.step) > 0)
        result.rows.push_back(measureAccuracy(model, c, result.reference, options.horizon));
    }

  const double before = kReferenceShare + kAccuracyShare;
  measureCosts(model, options.horizon, result.rows,
               [&](double share) { progress.show(before + (1 - before) * share, "timing"); });
  markBest(result.reference.uncertainty, result.rows);
  return result;
}

}  // namespace ragdoll::lab
