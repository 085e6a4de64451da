// ragdoll_lab crowd: what many bodies cost, beside one in the same run.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>

#include "arguments.h"
#include "commands.h"
#include "measurement.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::lab {
namespace {

constexpr const char* kAbout =
    "Lets N bodies fall side by side onto a floor, and one body alone, and says what a step of a "
    "body\n"
    "costs in each. CPU time of the steps alone; bodies are kept awake.\n";
constexpr int kMost = 10000;
constexpr int kRuns = 3;  ///< of which the cheapest counts

struct Throughput {
  int bodies = 0;
  double per_body_step = 0;   ///< [s] of CPU time
  double per_cpu_second = 0;  ///< [s] simulated
  double stick_error = 0;     ///< relative, at the end
};

Throughput measure(int bodies, const std::string& model_name, const Words& settings,
                   double seconds) {
  Scene scene = parseScene(
      "ragdolls: [{name: body, model: " + model_name + ", count: " + std::to_string(bodies) +
          ", spacing: [1.6, 1.6, 0], position: [0, 0, 2], rpy_deg: [10, 25, 0]}]\n"
          "obstacles: [{type: plane, friction: 0.6}]\n",
      "crowd");
  applySettings(scene, settings);
  scene.solver.sleep = false;
  const Model model = buildModel(scene);
  const Inputs inputs = startInputs(model);
  const int steps = std::max(1, static_cast<int>(std::lround(seconds / model.solver.step)));
  Throughput t;
  t.bodies = bodies;
  double best = INFINITY;
  for (int i = 0; i < kRuns; ++i) {
    State state = startState(model);
    Workspace workspace;
    const double begin = cpuTime();
    for (int k = 0; k < steps; ++k) step(model, inputs, workspace, state);
    best = std::min(best, std::max(1e-9, cpuTime() - begin));
    t.stick_error = maxStickError(model, state);
  }
  t.per_body_step = best / (1.0 * steps * bodies);
  t.per_cpu_second = steps * model.solver.step / best;
  return t;
}

int bodiesIn(const std::string& word) {
  std::size_t end = 0;
  int n = 0;
  try {
    n = std::stoi(word, &end);
  } catch (const std::exception&) {
  }
  if (end != word.size() || n < 1 || n > kMost)
    throw Error("N", "is '" + word + "'; a number of bodies in 1 ... " + std::to_string(kMost) +
                         " is expected");
  return n;
}

}  // namespace

int crowdCommand(const Words& words) {
  std::string n, model = "human";
  Words settings;
  double seconds = 2;
  CommandLine line{"crowd N [options]", kAbout, {}, "N", "how many bodies"};
  auto add = line.options.add_options();
  add("model", po::value(&model)->default_value(model), "Name or file of the bodies' model");
  add("seconds", po::value(&seconds)->default_value(seconds), "Simulated time [s]");
  add("set", po::value(&settings), "Change a setting, such as solver.preset=draft");
  if (!parse(line, words, n)) return kOk;
  checked("--seconds", seconds, false);
  const int bodies = bodiesIn(n);
  const Throughput one = measure(1, model, settings, seconds);
  const Throughput all = measure(bodies, model, settings, seconds);
  std::printf("bodies                          %10d %10d\n", one.bodies, all.bodies);
  std::printf("CPU time per body and step [us] %10.3g %10.3g   %.3g times\n",
              1e6 * one.per_body_step, 1e6 * all.per_body_step,
              all.per_body_step / one.per_body_step);
  std::printf("simulated per CPU second [s]    %10.3g %10.3g\n", one.per_cpu_second,
              all.per_cpu_second);
  std::printf("stick error at the end          %10.2g %10.2g\n", one.stick_error, all.stick_error);
  return std::isfinite(all.stick_error) && std::isfinite(one.stick_error) ? kOk : kCheckFailed;
}

}  // namespace ragdoll::lab
