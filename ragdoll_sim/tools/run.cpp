// ragdoll_lab run: steps a scene as fast as it can and writes what happened.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <string>

#include "arguments.h"
#include "commands.h"
#include "quantity.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/self_pairs.h"
#include "ragdoll_sim/io/csv.h"
#include "ragdoll_sim/io/summary.h"

namespace ragdoll::lab {
namespace {

constexpr double kMostSteps = 1e12;  ///< weeks of computing
constexpr double kRounding = 1e-9;   ///< part of a step by which a step may miss its tick

struct Options {
  std::string scene;
  double seconds = 10;
  std::string csv;
  double rate = 60;  ///< [Hz]
  bool summary = false, pairs = false;
  Words settings;
};

/// Writes the rows that are due: tick k is at k / rate, its row the first step at or after it.
class TickWriter {
 public:
  TickWriter(const Model& model, const Options& options)
      : model_(model),
        path_(options.csv),
        rate_(options.rate),
        slack_(kRounding * model.solver.step) {
    if (path_.empty()) return;
    file_.open(path_);
    if (!file_) throw Error(path_, "cannot be written");
    writeCsvHeader(model, file_);
  }

  void write(const State& state, double time) {
    if (path_.empty()) return;
    for (; static_cast<double>(tick_) / rate_ <= time + slack_; ++tick_) {
      writeCsvRow(model_, state, time, file_);
    }
  }

  void close() {
    if (path_.empty()) return;
    file_.close();
    if (!file_) throw Error(path_, "could not be written to the end");
  }

 private:
  const Model& model_;
  std::string path_;
  double rate_, slack_;
  std::uint64_t tick_ = 0;
  std::ofstream file_;
};

int run(const Options& options) {
  checked("--seconds", options.seconds, true);
  checked("--rate", options.rate, false);
  const Model model = buildModel(loadScene(options.scene, options.settings));
  for (const std::string& warning : model.warnings) std::cerr << "ragdoll_lab: " << warning << "\n";
  double taken = 0;
  startState(model, &taken);
  if (const std::string text = takenText(taken); !text.empty())
    std::cerr << "ragdoll_lab: " << text << "\n";
  for (const std::string& note : model.notes)
    std::cerr << "ragdoll_lab: " << (options.pairs ? note : inShort(note) + " (--pairs lists them)")
              << "\n";

  const double steps = std::ceil(options.seconds / model.solver.step - kRounding);
  if (steps > kMostSteps)
    throw Error("--seconds", "asks for more than 1e12 steps of " + timeText(model.solver.step));
  if (options.rate * std::max(options.seconds, model.solver.step) > kMostSteps)
    throw Error("--rate", "asks for more than 1e12 rows");

  TickWriter rows(model, options);
  WatchedRun world(model);
  rows.write(world.state(), world.time());
  for (double i = 0; i < steps; ++i) {
    world.step();
    rows.write(world.state(), world.time());
  }
  rows.close();

  const Summary summary = world.summary();
  if (options.summary) {
    std::cout << toJson(summary);
  } else {
    std::cout << summary.steps << " steps, " << summary.seconds << " s simulated in "
              << summary.wall_seconds << " s\n";
  }
  if (!std::cout.flush()) throw Error("stdout", "cannot be written");
  if (summary.finite) return kOk;
  std::cerr << "ragdoll_lab: " << options.scene << ": the simulation left the finite numbers\n";
  return kCheckFailed;
}

}  // namespace

int runCommand(const Words& words) {
  Options options;
  CommandLine line{"run SCENE [options]", "Steps a scene as fast as possible.", {}};
  auto add = line.options.add_options();
  add("seconds", po::value(&options.seconds)->default_value(10), "Simulated time [s]");
  add("csv", po::value(&options.csv), "Write a row per tick to this file");
  add("rate", po::value(&options.rate)->default_value(60), "Ticks of the CSV [Hz]");
  add("summary", po::bool_switch(&options.summary), "Print what happened as JSON");
  add("pairs", po::bool_switch(&options.pairs),
      "With self_collision: list the pairs of sticks that are left out");
  add("set", po::value(&options.settings),
      "Change a setting, such as solver.step=0.001; may be given again.\nsolver.preset sets all of "
      "the solver but joint_damping");
  return parse(line, words, options.scene) ? run(options) : kOk;
}

}  // namespace ragdoll::lab
