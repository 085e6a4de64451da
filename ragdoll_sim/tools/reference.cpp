#include "reference.h"

#include <algorithm>
#include <cmath>
#include <random>

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
constexpr double kShift = 1e-10;           ///< [m] over a window, by other velocities at its start
constexpr double kFork = 1e-5;             ///< [m] apart, after that: 1e5 times as far
constexpr double kParted = 0.01 * kFork;   ///< [m] when the fork is seen

/// When two runs, the second at half the step of the first, are near enough.
struct Goal {
  double agreement;  ///< [m]
  double finest;     ///< [Hz]
};
constexpr Goal kSmooth = {1e-8, 245760};
constexpr Goal kContact = {2e-9, 61440};
constexpr double kFiner = 8;  ///< times as often as the reference at its finest: the other, at most
constexpr double kConverges = 0.7;      ///< of the change before: what is of first order halves it
constexpr double kRoughFinest = 15360;  ///< [Hz] where less agreement is asked for

Goal goalOf(bool contact, double agreement) {
  Goal goal = contact ? kContact : kSmooth;
  if (agreement > goal.agreement) goal = {agreement, kRoughFinest};
  return goal;
}

/// The window's start in steps of the solver.
State startOf(const Window& window, const SolverSpec& solver) {
  State state = window.start;
  state.step = static_cast<std::uint64_t>(std::llround(state.time / solver.step));
  return state;
}

SolverSpec referenceSolver(const Model& model, Method method, double rate) {
  SolverSpec solver = model.solver;
  solver.method = method;
  solver.step = 1 / rate;
  solver.events = method == Method::kRk;
  return solver;
}

/// The window with velocities at its start that move the particles by kShift until its end: each by
/// numbers in [-1, 1] of a fixed sequence.
Window shifted(const Window& window, double length) {
  Window result = window;
  std::mt19937 random(1);
  for (int i = 0; i < result.start.v.size(); ++i)
    result.start.v.data()[i] += kShift / length * (random() / 2147483648.0 - 1);
  return result;
}

/// Whether the window forks, and when.
void findFork(const Model& model, double length, Window& window) {
  const SolverSpec solver = referenceSolver(model, kMethod, 1 / window.finest);
  const Window other = shifted(window, length);
  const int steps = stepsIn(length, window.finest);
  const State end = follow(model, solver, other, steps);
  window.forks = !(rmsDistance(model, end.x, window.end) < kFork);
  if (!window.forks) return;
  const Model own = withSolver(model, solver);
  const Inputs inputs = startInputs(own);
  Workspace first, second;
  State a = startOf(window, solver), b = startOf(other, solver);
  for (int i = 0; i < steps && rmsDistance(model, a.x, b.x) < kParted; ++i) {
    step(own, inputs, first, a);
    step(own, inputs, second, b);
  }
  window.fork_time = a.time;
}

/// Two methods that both claim to be converged, elsewhere: then neither claim is worth more. The
/// other one has its step halved until its own change, as it converges, accounts for the distance,
/// or that is small enough.
void compareWithOther(const Model& model, double length, Goal goal, Window& window) {
  const auto other = [&](double rate) {
    return follow(model, referenceSolver(model, kOther, rate), window, stepsIn(length, 1 / rate)).x;
  };
  Points fine = other(goal.finest / 2);
  double before = rmsDistance(model, fine, other(goal.finest / 4));
  window.disagreement = INFINITY;
  for (double rate = goal.finest; rate <= kFiner * goal.finest; rate *= 2) {
    const Points half = std::move(fine);
    fine = other(rate);
    const double apart = rmsDistance(model, fine, window.end);
    const double change = rmsDistance(model, fine, half);
    window.disagreement = std::min(window.disagreement, apart);
    if (apart <= window.uncertainty + change && change < kConverges * before) return;
    if (apart <= goal.agreement) break;
    before = change;
  }
  window.uncertainty = std::max(window.uncertainty, window.disagreement);
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
  compareWithOther(model, length, goal, window);
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

int countOf(const Reference& reference) {
  const int all = static_cast<int>(reference.windows.size());
  return reference.forks < all ? all - reference.forks : all;
}

bool counts(const Reference& reference, const Window& window) {
  return !window.forks || reference.forks == static_cast<int>(reference.windows.size());
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
  State state = startOf(window, solver);
  for (int i = 0; i < steps; ++i) step(own, inputs, workspace, state);
  return state;
}

Reference makeReference(const Model& model, double horizon, double window,
                        const std::function<void(double)>& report, double agreement) {
  Reference reference;
  reference.window = window;
  reference.method = kMethod;
  reference.other = kOther;
  const int count = stepsIn(horizon, window);
  const Goal goal = goalOf(count > 1 || hasContact(model), agreement);
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
    converge(model, window, goal, w);
    if (k + 1 < count) state = follow(model, fine, w, stepsIn(window, fine.step));
    if (hasContact(model)) findFork(model, window, w);
    reference.forks += w.forks;
    reference.finest = reference.finest > 0 ? std::min(reference.finest, w.finest) : w.finest;
    reference.windows.push_back(std::move(w));
  }
  const int counted = countOf(reference);
  for (const Window& w : reference.windows) {
    if (!counts(reference, w)) continue;
    reference.uncertainty += w.uncertainty / counted;
    reference.disagreement += w.disagreement / counted;
    reference.worst = std::max(reference.worst, w.uncertainty);
  }
  return reference;
}

}  // namespace ragdoll::lab
