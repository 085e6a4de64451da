#include "golden_cases.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "extreme_random.h"
#include "extreme_tests.h"
#include "extreme_verdict.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::golden {
namespace {

constexpr double kRounding = 1e-9;  ///< of a step
constexpr double kRestDamping = 2;  ///< [1/s] of extremes that come to rest, as judge() has it

/// [s] long enough to land and to lie, less for twenty bodies.
double secondsOf(const std::string& scene, const SolverSpec& solver) {
  if (scene == "crowd") return solver.step < 1.0 / 400 ? 0.7 : 1.5;
  return 3;
}

std::vector<std::string> shippedScenes() {
  std::vector<std::string> names;
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(RAGDOLL_SHARE_DIR) + "/scenes"))
    if (file.path().extension() == ".yaml") names.push_back(file.path().stem().string());
  std::sort(names.begin(), names.end());  // a folder has no order
  return names;
}

/// The shipped scene by another method; its damping is its own.
Case shipped(const std::string& scene, const std::string& how, SolverSpec solver) {
  return {"shipped", "shipped: " + scene + ", " + how, [=]() mutable {
            Scene s = loadScene(scene);
            solver.damping = s.solver.damping;
            solver.joint_damping = s.solver.joint_damping;
            s.solver = solver;
            return outcomeOf(s, secondsOf(scene, solver));
          }};
}

/// The matrix's own settings, for so long at most.
Outcome outcomeOf(const lab::Extreme& extreme, const lab::ExtremeMethod& method, double seconds,
                  int most_steps) {
  Scene scene = extreme.scene;
  scene.solver = method.solver;
  scene.solver.sleep = extreme.sleep;
  if (extreme.laws.rest) scene.solver.joint_damping = kRestDamping;
  if (extreme.step > 0) scene.solver.step = extreme.step;
  if (extreme.sweeps > 0) scene.solver.sweeps = extreme.sweeps;
  Script script;
  if (extreme.drive)
    script = [&extreme](Run& run) {
      run.inputs.obstacles = run.state.obstacles;
      extreme.drive(run.state.time + run.model.solver.step, run.inputs.obstacles);
    };
  return golden::outcomeOf(
      scene, std::min({seconds, extreme.seconds, most_steps * scene.solver.step}), script);
}

/// Mostly the default.
lab::ExtremeMethod methodOf(std::uint32_t seed) {
  const char* wanted = seed % 8 == 3 ? "rk" : seed % 8 == 7 ? "jakobsen" : "shake";
  for (const lab::ExtremeMethod& method : lab::extremeMethods())
    if (method.name == wanted) return method;
  return {};
}

void addRandom(std::vector<Case>& cases, const std::string& group, int count, double seconds,
               lab::Extreme (*draw)(std::uint32_t)) {
  for (int seed = 0; seed < count; ++seed) {
    const lab::ExtremeMethod method = methodOf(static_cast<std::uint32_t>(seed));
    cases.push_back({group, group + ": seed " + std::to_string(seed) + ", " + method.name, [=] {
                       return outcomeOf(draw(static_cast<std::uint32_t>(seed)), method, seconds,
                                        1000000);
                     }});
  }
}

}  // namespace

Outcome outcomeOf(const Scene& scene, double seconds, const Script& script) {
  Run run(scene);
  const int steps = static_cast<int>(std::ceil(seconds / run.model.solver.step - kRounding));
  for (int i = 0; i < steps; ++i) {
    if (script) script(run);
    run.step();
  }
  return run.outcome();
}

void addShipped(std::vector<Case>& cases) {
  for (const std::string& scene : shippedScenes())
    for (const std::string& name : presetNames())
      cases.push_back(shipped(scene, name, preset(name)));
  for (const char* scene : {"between_objects", "hang", "stairs", "two"})
    for (const double tolerance : {1e-2, 1e-5}) {
      SolverSpec solver = preset("reference");
      solver.step = 1.0 / 60;
      solver.tolerance = tolerance;
      cases.push_back(shipped(scene, tolerance > 1e-3 ? "rk to 1e-2" : "rk to 1e-5", solver));
    }
  const std::pair<const char*, Integrator> integrators[] = {
      {"euler", Integrator::kEuler},
      {"symplectic euler", Integrator::kSymplecticEuler},
      {"midpoint", Integrator::kMidpoint},
      {"velocity verlet", Integrator::kVelocityVerlet}};
  for (const auto& [name, integrator] : integrators) {
    SolverSpec solver = preset("thesis");
    solver.integrator = integrator;
    cases.push_back(shipped("stairs", std::string("thesis by ") + name, solver));
  }
}

void addExtremes(std::vector<Case>& cases) {
  constexpr double kSeconds = 2.5;  ///< simulated
  constexpr int kSteps = 2500;
  for (const lab::Extreme& extreme : lab::extremeTests(true))
    for (const lab::ExtremeMethod& method : lab::extremeMethods()) {
      if (extreme.sweeps > 0 && method.solver.method != Method::kJakobsen) continue;
      cases.push_back({"extremes",
                       "extremes: " + extreme.group + ", " + extreme.name + ", " + method.name,
                       [=] { return outcomeOf(extreme, method, kSeconds, kSteps); }});
    }
  addRandom(cases, "random scenes", 200, 3, lab::randomExtreme);
  addRandom(cases, "random piles", 50, 3, lab::randomPile);
}

std::vector<Case> allCases() {
  std::vector<Case> cases;
  addShipped(cases);
  addScripted(cases);
  addExtremes(cases);
  return cases;
}

}  // namespace ragdoll::golden
