#include "measurement.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "pareto.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/summary.h"

namespace ragdoll::lab {
namespace {

constexpr int kCostRounds = 7;            ///< repetitions whose median counts
constexpr int kFewCostRounds = 3;         ///< of configurations dearer than kDear
constexpr double kDear = 0.1;             ///< [s] of one run
constexpr double kShortestTiming = 2e-3;  ///< [s] what is shorter is run several times

/// Runs one configuration again and again from the scene's start.
class ConfigurationRunner {
 public:
  ConfigurationRunner(const Model& model, const SolverSpec& solver, double horizon)
      : model_(withSolver(model, solver)),
        inputs_(startInputs(model_)),
        start_(startState(model_)),
        steps_(std::max(1, static_cast<int>(std::ceil(horizon / solver.step - 1e-9)))) {
    once();  // grows the scratch memory, fills the caches
    const double time = once();
    passes_ = std::clamp(static_cast<int>(std::ceil(kShortestTiming / time)), 1, 1000);
  }

  /// [s] of CPU time per simulated second.
  double measure() {
    double sum = 0;
    for (int i = 0; i < passes_; ++i) sum += once();
    last_ = sum / passes_;
    return last_ / (steps_ * model_.solver.step);
  }

  double seconds() const { return last_; }  ///< [s] of one run, the last time

 private:
  double once() {
    State state = start_;
    const double begin = cpuTime();
    for (int i = 0; i < steps_; ++i) step(model_, inputs_, workspace_, state);
    return std::max(1e-9, cpuTime() - begin);
  }

  Model model_;
  Inputs inputs_;
  Workspace workspace_;
  State start_;
  int steps_, passes_ = 1;
  double last_ = 0;
};

/// Of the windows that count, means.
struct Errors {
  double error = 0, energy_drift = 0;
};

Errors atEnds(const Model& model, const SolverSpec& solver, const Reference& reference) {
  Errors mean;
  const int steps = stepsIn(reference.window, solver.step);
  const double count = countOf(reference);
  for (const Window& window : reference.windows) {
    if (!counts(reference, window)) continue;
    const State end = follow(model, solver, window, steps);
    mean.error += rmsDistance(model, end.x, window.end) / count;
    mean.energy_drift +=
        (kineticEnergy(model, end) + potentialEnergy(model, end) - window.energy_end) / count;
  }
  if (!std::isfinite(mean.error)) mean.error = INFINITY;
  return mean;
}

}  // namespace

double cpuTime() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

double errorAgainst(const Model& model, const SolverSpec& solver, const Reference& reference) {
  return atEnds(model, solver, reference).error;
}

Measurement measureAccuracy(const Model& model, const Configuration& configuration,
                            const Reference& reference, double horizon) {
  Measurement m;
  m.configuration = configuration;
  const SolverSpec& solver = configuration.solver;
  const Errors errors = atEnds(model, solver, reference);
  m.error = errors.error;
  m.energy_drift = errors.energy_drift;
  const Model own = withSolver(model, solver);
  WatchedRun run(own);
  for (double i = std::ceil(horizon / solver.step - 1e-9); i > 0; --i) run.step();
  const Summary summary = run.summary();
  m.stretch = summary.max_stick_error;
  m.penetration = summary.max_penetration;
  m.limit_violation = summary.max_limit_violation;
  m.energy_rise = summary.max_energy_rise;
  m.finite = summary.finite && std::isfinite(m.error);
  if (!m.finite) m.error = INFINITY;
  return m;
}

void measureCosts(const Model& model, double horizon, std::vector<Measurement>& all,
                  const std::function<void(double)>& report) {
  ConfigurationRunner thesis(model, damped(preset("thesis"), model.solver), horizon);
  std::size_t done = 0;
  for (Measurement& m : all) {
    report(static_cast<double>(done++) / static_cast<double>(all.size()));
    ConfigurationRunner runner(model, m.configuration.solver, horizon);
    std::vector<double> costs, ratios;
    for (int round = 0; round < kCostRounds; ++round) {
      const double yardstick = thesis.measure();
      costs.push_back(runner.measure());
      ratios.push_back(costs.back() / yardstick);
      if (round + 1 >= kFewCostRounds && runner.seconds() > kDear) break;
    }
    m.cost = median(costs);
    m.ratio = median(ratios);
  }
}

void measureCost(const Model& model, double horizon, Measurement& one) {
  std::vector<Measurement> single = {one};
  measureCosts(model, horizon, single, [](double) {});
  one = single.front();
}

void markBest(double uncertainty, std::vector<Measurement>& all) {
  std::vector<CostAndError> items;
  for (const Measurement& m : all) items.push_back({m.cost, std::max(m.error, uncertainty)});
  const std::vector<bool> front = paretoFront(items);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].best = front[i];
}

}  // namespace ragdoll::lab
