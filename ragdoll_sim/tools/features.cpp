// ragdoll_lab features: what each thing that a scene may ask for costs when it is switched on
// alone.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "arguments.h"
#include "commands.h"
#include "feature_list.h"
#include "measurement.h"
#include "progress.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::lab {
namespace {

constexpr const char* kAboutFeatures =
    "Switches the features of a scene on, one at a time, on top of the same bare scene, and says\n"
    "what each costs: CPU time per simulated second and body, and its ratio to the bare scene, "
    "the\n"
    "median of runs that take turns with the bare one. Bodies are kept awake.\n";
constexpr int kFeatureRounds = 9;
constexpr double kPublishRate = 60;           ///< [Hz]
constexpr double kShortestFeatureRun = 2e-3;  ///< [s] of a run; shorter ones are repeated

class FeatureRunner {
 public:
  FeatureRunner(const Feature& feature, const Words& settings, double seconds) : feature_(feature) {
    Scene scene = parseScene(feature.scene, feature.name);
    applySettings(scene, settings);
    scene.solver.sleep = false;
    if (!feature.limits) dropLimits(scene);
    model_ = buildModel(scene);
    start_ = startState(model_);
    inputs_ = startInputs(model_);
    steps_ = stepsOf("--seconds", seconds, model_.solver.step);
    once();  // grows the scratch memory, fills the caches
  }

  /// [s] of CPU time per simulated second and body.
  double measure() {
    double sum = 0;
    int runs = 0;
    for (; sum < kShortestFeatureRun; ++runs) sum += once();
    return sum / (runs * steps_ * model_.solver.step * static_cast<double>(model_.ragdolls.size()));
  }

 private:
  double once() {
    State state = start_;
    std::unique_ptr<Follower> follower;
    if (feature_.follower) follower = feature_.follower(model_, state);
    if (follower) follower->begin(workspace_);
    double next = 0;
    const double begin = cpuTime();
    for (int i = 0; i < steps_; ++i) {
      if (follower) follower->beforeStep(state);
      step(model_, inputs_, workspace_, state);
      if (!follower) continue;
      follower->stepped(state);
      if (state.time < next) continue;
      follower->publish(state);
      next += 1 / kPublishRate;
    }
    const double passed = cpuTime() - begin;
    workspace_.keepContacts(nullptr);
    return std::max(1e-9, passed);
  }

  const Feature& feature_;
  Model model_;
  State start_;
  Inputs inputs_;
  Workspace workspace_;
  int steps_ = 1;
};

int measureAll(const Words& settings, double seconds) {
  const std::vector<Feature> all = features();
  FeatureRunner bare(all[0], settings, seconds);
  std::string table =
      "feature                                                            "
      "[us/s]  / bare\n";
  {
    Progress progress;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const std::string name = all[i].group + ": " + all[i].name;
      progress.show(static_cast<double>(i) / static_cast<double>(all.size()), name);
      FeatureRunner runner(all[i], settings, seconds);
      std::vector<double> costs, ratios;
      for (int round = 0; round < kFeatureRounds; ++round) {
        const double yardstick = bare.measure();
        costs.push_back(runner.measure());
        ratios.push_back(costs.back() / yardstick);
      }
      char line[200];
      std::snprintf(line, sizeof line, "%-64s %8.0f %7.2f\n", name.c_str(), 1e6 * median(costs),
                    median(ratios));
      table += line;
    }
  }
  std::cout << table;
  return std::cout.flush() ? kOk : kCheckFailed;
}

}  // namespace

int featuresCommand(const Words& words) {
  Words settings;
  double seconds = 2;
  CommandLine line{"features [options]", kAboutFeatures, {}};
  auto add = line.options.add_options();
  add("seconds", po::value(&seconds)->default_value(seconds), "Simulated time of a run [s]");
  add("set", po::value(&settings),
      "Change a setting, such as solver.preset=draft; may be given again");
  if (!parse(line, words)) return kOk;
  checked("--seconds", seconds, false);
  return measureAll(settings, seconds);
}

}  // namespace ragdoll::lab
