#include "ragdoll_sim/core/solver_presets.h"

#include "ragdoll_sim/core/error.h"

namespace ragdoll {
namespace {

struct Preset {
  const char* name;
  Method method;
  Integrator integrator;
  double step;  ///< [s]
  int sweeps;
  const char* error;
};

// Relaxation is first order in the step: below its 1/60 s it never catches up with the direct
// method.
constexpr Preset kPresets[] = {
    {"thesis", Method::kJakobsen, Integrator::kVerlet, 1.0 / 60, 10, "20 mm"},
    {"fast", Method::kFast, Integrator::kVerlet, 1.0 / 60, 10, "5 mm"},
    {"draft", Method::kShake, Integrator::kVerlet, 1.0 / 60, 10, "2 mm"},
    {"balanced", Method::kShake, Integrator::kVerlet, 1.0 / 120, 10, "0.7 mm"},
    {"precise", Method::kShake, Integrator::kVerlet, 1.0 / 500, 10, "0.07 mm"},
    {"reference", Method::kRk, Integrator::kVerlet, 1.0 / 1000, 10, "0.007 mm"},
};

}  // namespace

const std::vector<std::string>& methodNames() {
  static const std::vector<std::string> names = {"jakobsen", "shake", "rk", "fast"};
  return names;
}

const std::vector<std::string>& integratorNames() {
  static const std::vector<std::string> names = {"verlet", "euler", "symplectic_euler", "midpoint",
                                                 "velocity_verlet"};
  return names;
}

const std::vector<std::string>& presetNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Preset& preset : kPresets) list.emplace_back(preset.name);
    return list;
  }();
  return names;
}

std::string errorClass(const SolverSpec& solver) {
  for (const Preset& p : kPresets)
    if (solver.preset == p.name && solver.method == p.method && solver.step == p.step &&
        (p.method != Method::kRk || solver.tolerance == SolverSpec().tolerance) &&
        (p.method != Method::kJakobsen ||
         (solver.integrator == p.integrator && solver.sweeps == p.sweeps)))
      return p.error;
  return "";
}

SolverSpec preset(const std::string& name) {
  for (const Preset& values : kPresets) {
    if (name != values.name) continue;
    SolverSpec solver;
    solver.preset = name;
    solver.method = values.method;
    solver.integrator = values.integrator;
    solver.step = values.step;
    solver.sweeps = values.sweeps;
    return solver;
  }
  std::string names;
  for (const std::string& known : presetNames()) names += (names.empty() ? "" : ", ") + known;
  throw Error("solver.preset", "there is no preset '" + name + "'; there are " + names);
}

}  // namespace ragdoll
