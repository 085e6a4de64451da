#include "families.h"

#include <cstdio>
#include <iterator>

namespace ragdoll::lab {
namespace {

/// A method that the lab measures: a line here is all that a new one needs.
struct MethodEntry {
  Method method;
  const char* name;
  double coarsest, finest;  ///< [Hz]
  std::vector<int> sweeps;  ///< empty: the method has no sweeps
};

const std::vector<MethodEntry>& methods() {
  static const std::vector<MethodEntry> table = {
      {Method::kJakobsen, "jakobsen", 60, 15360, {1, 4, 10, 40}},
      {Method::kShake, "shake", 30, 61440, {}},
      {Method::kRk, "rk", 30, 15360, {}},
      {Method::kFast, "fast", 30, 1920, {}},
  };
  return table;
}

constexpr int kUsualSweeps = 10;      ///< of the thesis
constexpr double kAdaptiveRate = 30;  ///< [Hz] of the whole steps; substeps follow the tolerance
constexpr const char* kTolerances[] = {"0.1", "0.01", "0.001", "1e-05", "1e-07"};  ///< [m] of rk
constexpr const char* kShakeTolerances[] = {"0.1", "0.01", "0.001", "0.0001"};
/// Likewise, of rk through events: for coarser ones its parts by shake do as well at less cost.
constexpr const char* kEventTolerances[] = {"0.0001", "1e-05", "1e-06"};
constexpr const char* kIntegrators[] = {"verlet", "euler", "symplectic_euler", "midpoint",
                                        "velocity_verlet"};

/// A family whose substeps keep to a tolerance.
Family within(const char* tolerance, Family family) {
  family.name += std::string(" to ") + tolerance;
  family.coarsest = family.finest = kAdaptiveRate;
  family.solver.tolerance = std::stod(tolerance);
  return family;
}

}  // namespace

const char* methodName(Method method) {
  for (const MethodEntry& entry : methods())
    if (entry.method == method) return entry.name;
  return "";
}

const char* integratorName(Integrator integrator) {
  return kIntegrators[static_cast<int>(integrator)];
}

std::vector<Family> families(bool integrators) {
  std::vector<Family> all;
  for (const MethodEntry& entry : methods()) {
    Family family{entry.name, {}, entry.coarsest, entry.finest};
    family.solver.preset.clear();
    family.solver.method = entry.method;
    if (entry.sweeps.empty()) all.push_back(family);
    if (entry.method == Method::kShake)
      for (const char* tolerance : kShakeTolerances) all.push_back(within(tolerance, family));
    if (entry.method == Method::kRk) {
      for (const char* tolerance : kTolerances) all.push_back(within(tolerance, family));
      family.name += kWithEvents;
      family.solver.events = true;
      for (const char* tolerance : kEventTolerances) all.push_back(within(tolerance, family));
    }
    for (const int sweeps : entry.sweeps) {
      family.solver.sweeps = sweeps;
      family.name = entry.name + (" " + std::to_string(sweeps));
      all.push_back(family);
      if (!integrators || sweeps != kUsualSweeps) continue;
      for (int i = 1; i < static_cast<int>(std::size(kIntegrators)); ++i) {
        Family other = family;
        other.solver.integrator = static_cast<Integrator>(i);
        other.name += " " + std::string(kIntegrators[i]);
        all.push_back(other);
      }
    }
  }
  return all;
}

SolverSpec at(const Family& family, double rate) {
  SolverSpec solver = family.solver;
  solver.step = 1 / rate;
  return solver;
}

SolverSpec damped(SolverSpec solver, const SolverSpec& scene) {
  solver.damping = scene.damping;
  solver.joint_damping = scene.joint_damping;
  return solver;
}

std::string toSection(const SolverSpec& solver) {
  char step[64];
  std::snprintf(step, sizeof step, "%.17g   # %.5g Hz", solver.step, 1 / solver.step);
  std::string text =
      "solver:\n  method: " + std::string(methodName(solver.method)) + "\n  step: " + step + "\n";
  if (solver.method == Method::kJakobsen) {
    text += "  sweeps: " + std::to_string(solver.sweeps) + "\n";
    text += "  integrator: " + std::string(integratorName(solver.integrator)) + "\n";
  }
  if (solver.tolerance > 0) {
    std::snprintf(step, sizeof step, "  tolerance: %.17g   # [m]\n", solver.tolerance);
    text += step;
  }
  if (solver.events) text += "  events: true\n";
  if (solver.damping > 0) {
    std::snprintf(step, sizeof step, "  damping: %.17g\n", solver.damping);
    text += step;
  }
  if (solver.joint_damping > 0) {
    std::snprintf(step, sizeof step, "  joint_damping: %.17g\n", solver.joint_damping);
    text += step;
  }
  return text;
}

}  // namespace ragdoll::lab
