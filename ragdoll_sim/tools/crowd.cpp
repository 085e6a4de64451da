// ragdoll_lab crowd: what many bodies cost, beside one in the same run.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "arguments.h"
#include "commands.h"
#include "measurement.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::lab {
namespace {

constexpr const char* kAboutCrowd =
    "Lets N bodies fall side by side onto a floor, and one body alone, and says what a step of a\n"
    "body costs in each: CPU time of the steps alone, the median of runs that take turns. Bodies\n"
    "are kept awake.\n";
constexpr int kMost = 10000;
constexpr int kCrowdRounds = 5;             ///< of which the median counts
constexpr int kFewCrowdRounds = 3;          ///< of crowds whose run is longer than kLong
constexpr double kLong = 5;                 ///< [s]
constexpr double kShortestCrowdRun = 0.02;  ///< [s] what is shorter is run several times

class Crowd {
 public:
  Crowd(int bodies, const std::string& model_name, const Words& settings, double seconds,
        int threads)
      : bodies_(bodies) {
    Scene scene = parseScene(
        "ragdolls: [{name: body, model: " + model_name + ", count: " + std::to_string(bodies) +
            ", spacing: [1.6, 1.6, 0], position: [0, 0, 2], rpy_deg: [10, 25, 0]}]\n"
            "obstacles: [{type: plane, friction: 0.6}]\n",
        "crowd");
    applySettings(scene, settings);
    scene.solver.sleep = false;
    if (threads >= 0) scene.solver.threads = threads;
    model_ = buildModel(scene);
    inputs_ = startInputs(model_);
    steps_ = stepsOf("--seconds", seconds, model_.solver.step);
  }

  /// CPU time [s] of one step of one body, from the start to the end.
  double measure() {
    double sum = 0;
    int runs = 0;
    for (; sum < kShortestCrowdRun; ++runs) {
      State state = startState(model_);
      const double begin = cpuTime();
      const auto clock = std::chrono::steady_clock::now();
      for (int k = 0; k < steps_; ++k) step(model_, inputs_, workspace_, state);
      last_ = std::max(1e-9, cpuTime() - begin);
      const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - clock;
      wall_ = wall.count() / (1.0 * steps_ * bodies_);
      sum += last_;
      stick_error_ = maxStickError(model_, state);
    }
    return sum / (1.0 * runs * steps_ * bodies_);
  }

  int bodies() const { return bodies_; }
  double lastRun() const { return last_; }  ///< [s]
  double wall() const { return wall_; }     ///< [s] of a body's step, of the last run
  int threads() const { return model_.solver.threads; }
  double stickError() const { return stick_error_; }  ///< relative, at the end
  /// [s] simulated
  double perCpuSecond(double per_body_step) const {
    return model_.solver.step / (per_body_step * bodies_);
  }

 private:
  int bodies_, steps_ = 1;
  Model model_;
  Inputs inputs_;
  Workspace workspace_;
  double last_ = 0, wall_ = 0, stick_error_ = 0;
};

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
  int threads = -1;
  bool json = false;
  CommandLine line{"crowd N [options]", kAboutCrowd, {}, "N", "how many bodies"};
  auto add = line.options.add_options();
  add("model", po::value(&model)->default_value(model), "Name or file of the bodies' model");
  add("seconds", po::value(&seconds)->default_value(seconds), "Simulated time [s]");
  add("set", po::value(&settings),
      "Change a setting, such as solver.preset=draft; may be given again");
  add("threads", po::value(&threads), "Of a step, 0: all cores; else the settings'");
  add("json", po::bool_switch(&json), "Print one JSON object");
  if (!parse(line, words, n)) return kOk;
  checked("--seconds", seconds, false);
  const int bodies = bodiesIn(n);
  Crowd one(1, model, settings, seconds, threads);
  Crowd all(bodies, model, settings, seconds, threads);
  std::vector<double> alone, among, ratios, walls;
  for (int round = 0; round < kCrowdRounds; ++round) {
    alone.push_back(one.measure());
    among.push_back(all.measure());
    walls.push_back(all.wall());
    ratios.push_back(among.back() / alone.back());
    if (round + 1 >= kFewCrowdRounds && all.lastRun() > kLong) break;
  }
  const bool finite = std::isfinite(all.stickError()) && std::isfinite(one.stickError());
  if (json) {
    const double wall = median(walls);
    const nlohmann::json out = {{"bodies", bodies},
                                {"threads", all.threads()},
                                {"us_per_body_step", 1e6 * median(among)},
                                {"wall_us_per_body_step", 1e6 * wall},
                                {"us_alone", 1e6 * median(alone)},
                                {"simulated_per_wall_second", all.perCpuSecond(wall)},
                                {"stick_error", all.stickError()}};
    std::printf("%s\n", out.dump(2).c_str());
    return finite ? kOk : kCheckFailed;
  }
  std::printf("bodies                          %10d %10d\n", one.bodies(), all.bodies());
  std::printf("CPU time per body and step [us] %10.3g %10.3g   %.3g times\n", 1e6 * median(alone),
              1e6 * median(among), median(ratios));
  std::printf("simulated per CPU second [s]    %10.3g %10.3g\n", one.perCpuSecond(median(alone)),
              all.perCpuSecond(median(among)));
  std::printf("stick error at the end          %10.2g %10.2g\n", one.stickError(),
              all.stickError());
  return finite ? kOk : kCheckFailed;
}

}  // namespace ragdoll::lab
