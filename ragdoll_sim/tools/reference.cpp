#include "reference.h"

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/step.h"

namespace ragdoll::lab {
namespace {

constexpr Method kMethod = Method::kRk;    ///< the most accurate there is
constexpr Method kOther = Method::kShake;  ///< an independent one, to compare with
constexpr double kTrajectoryRate = 3840;   ///< [Hz] of the run that gives the windows' starts
constexpr double kCoarsest = 1920;         ///< [Hz] the first of the runs that are halved

/// When two runs, the second at half the step of the first, are near enough.
struct Goal {
  double agreement;  ///< [m]
  double finest;     ///< [Hz]
};
constexpr Goal kSmooth = {1e-8, 245760};
constexpr Goal kContact = {1e-6, 61440};

SolverSpec referenceSolver(const Model& model, Method method, double rate) {
  SolverSpec solver = model.solver;
  solver.method = method;
  solver.step = 1 / rate;
  return solver;
}

void converge(const Model& model, double length, Goal goal, Window& window) {
  Points before;
  double best = INFINITY;
  for (double rate = kCoarsest; rate <= goal.finest; rate *= 2) {
    const State end =
        follow(model, referenceSolver(model, kMethod, rate), window, stepsIn(length, 1 / rate));
    const double change = before.size() > 0 ? rmsDistance(model, end.x, before) : INFINITY;
    before = end.x;
    // Below, rounding or the order of impacts decides, and a smaller step is no better.
    if (!(change < best) && std::isfinite(best)) {
      if (change > 4 * best || change < 1e-6) break;
    }
    best = window.uncertainty = change;
    window.end = end.x;
    window.energy_end = kineticEnergy(model, end) + potentialEnergy(model, end);
    window.finest = 1 / rate;
    if (change <= goal.agreement) break;
  }
  if (!std::isfinite(window.uncertainty))
    throw Error("", "the reference itself leaves the finite numbers: nothing to compare with");
  const auto other = [&](double rate) {
    return follow(model, referenceSolver(model, kOther, rate), window, stepsIn(length, 1 / rate)).x;
  };
  const Points fine = other(goal.finest), half = other(goal.finest / 2);
  window.disagreement = rmsDistance(model, fine, window.end);
  // Two methods that both claim to be converged, elsewhere: then neither claim is worth more.
  if (window.disagreement > window.uncertainty + rmsDistance(model, fine, half))
    window.uncertainty = window.disagreement;
}

}  // namespace

Model withSolver(const Model& model, const SolverSpec& solver) {
  Model result = model;
  result.solver = solver;
  result.solver.sleep = false;
  return result;
}

bool hasContact(const Model& model) {
  return !model.obstacles.empty() || model.self_collision || model.ragdoll_collision;
}

int stepsIn(double window, double step) {
  const double steps = std::round(window / step);
  return steps >= 1 && std::abs(steps * step / window - 1) < 1e-9 ? static_cast<int>(steps) : 0;
}

double rmsDistance(const Model& model, const Points& a, const Points& b) {
  double sum = 0;
  int count = 0;
  for (const Ragdoll& r : model.ragdolls) {
    const int n = model.skeletonOf(r).named;
    sum += (a.middleCols(r.first, n) - b.middleCols(r.first, n)).squaredNorm();
    count += n;
  }
  return std::sqrt(sum / count);
}

State follow(const Model& model, const SolverSpec& solver, const Window& window, int steps) {
  const Model own = withSolver(model, solver);
  const Inputs inputs = startInputs(own);
  Workspace workspace;
  State state = window.start;
  state.step = static_cast<std::uint64_t>(std::llround(state.time / solver.step));
  for (int i = 0; i < steps; ++i) step(own, inputs, workspace, state);
  return state;
}

Reference makeReference(const Model& model, double horizon, double window,
                        const std::function<void(double)>& report) {
  Reference reference;
  reference.window = window;
  reference.method = kMethod;
  reference.other = kOther;
  const int count = stepsIn(horizon, window);
  const SolverSpec fine = referenceSolver(model, kMethod, kTrajectoryRate);
  State state = startState(model);
  for (int k = 0; k < count; ++k) {
    report(static_cast<double>(k) / count);
    Window w;
    w.start = state;
    w.start.time = k * window;
    w.start.multipliers.clear();  // no method starts with what another has learned
    std::fill(w.start.quiet.begin(), w.start.quiet.end(), 0.0);
    std::fill(w.start.asleep.begin(), w.start.asleep.end(), 0);
    converge(model, window, count > 1 || hasContact(model) ? kContact : kSmooth, w);
    if (k + 1 < count) state = follow(model, fine, w, stepsIn(window, fine.step));
    reference.uncertainty += w.uncertainty / count;
    reference.disagreement += w.disagreement / count;
    reference.worst = std::max(reference.worst, w.uncertainty);
    reference.finest = reference.finest > 0 ? std::min(reference.finest, w.finest) : w.finest;
    reference.windows.push_back(std::move(w));
  }
  return reference;
}

}  // namespace ragdoll::lab
