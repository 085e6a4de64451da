// ragdoll_lab run: steps a scene as fast as it can and writes what happened.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "commands.h"
#include "quantity.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/self_pairs.h"
#include "ragdoll_sim/io/csv.h"
#include "ragdoll_sim/io/summary.h"
#include "ragdoll_sim/world/contacts.h"
#include "ragdoll_sim/world/imu.h"
#include "ragdoll_sim/world/injury.h"
#include "ragdoll_sim/world/sense_csv.h"
#include "rows.h"

namespace ragdoll::lab {
namespace {

constexpr double kMostSteps = 1e12;  ///< weeks of computing
constexpr double kRounding = 1e-9;   ///< part of a step by which the end may miss one

struct RunOptions {
  std::string scene;
  double seconds = 10;
  std::string csv, imu, contacts;
  double rate = 60;  ///< [Hz]
  bool summary = false, pairs = false;
  Words settings;
};

/// Writes the rows that are due: tick k is at k / rate, its row the first step at or after it.
class TickWriter {
 public:
  TickWriter(const Model& model, const RunOptions& options)
      : model_(model), file_(options.csv), ticks_(model, options.rate) {
    if (file_.wanted()) writeCsvHeader(model, file_.out());
  }

  void write(const State& state, double time) {
    if (!file_.wanted()) return;
    for (int i = ticks_.due(time); i > 0; --i) writeCsvRow(model_, state, time, file_.out());
  }

  void close() { file_.close(); }

 private:
  const Model& model_;
  RowFile file_;
  Ticks ticks_;
};

/// A row for each sample of the scene's sensors.
class ImuWriter {
 public:
  ImuWriter(const Model& model, const std::string& path) : model_(model), file_(path) {
    if (!model.sensors.empty()) {  // they are right, or an error, whether they are wanted or not
      checkSensorNames(model, FrameTracker(model));
      Imus checked(model);
    }
    if (!file_.wanted()) return;
    if (model.sensors.empty())
      throw Error("--imu", "the scene has no sensors; its key 'sensors' makes them");
    writeImuHeader(file_.out());
  }

  void begin(const State& state) {
    if (!file_.wanted()) return;
    imus_.emplace(model_);
    imus_->reset(state);
  }

  void write(const State& state) {
    if (!imus_) return;
    samples_.clear();
    imus_->update(model_, state, samples_);
    for (const ImuSample& sample : samples_) writeImuRow(model_, sample, file_.out());
  }

  void close() { file_.close(); }

 private:
  const Model& model_;
  RowFile file_;
  std::optional<Imus> imus_;
  std::vector<ImuSample> samples_;
};

/// Rows of what touched in the time of each tick, and for the summary what it came to.
class ContactWriter {
 public:
  ContactWriter(const Model& model, const RunOptions& options)
      : model_(model),
        file_(options.contacts),
        ticks_(model, options.rate),
        summary_(options.summary) {
    if (file_.wanted() || options.summary) contacts_.emplace(model);
    if (file_.wanted()) writeContactHeader(file_.out());
    ticks_.due(0);
  }

  void begin(WatchedRun& world) {
    if (!contacts_) return;
    world.keepContacts(&contacts_->log());
    contacts_->begin(world.state());
  }

  void end(const WatchedRun& world) {
    if (!contacts_) return;
    contacts_->end(model_, world.inputs(), world.state());
    for (const ContactImpulse& c : contacts_->last())
      if (c.obstacle >= 0) sum_ += c.impulse;
    if (summary_) loads_.add(model_, contacts_->last(), model_.solver.step);
    if (ticks_.due(world.time()) > 0) tell();
  }

  void close() {
    if (contacts_) tell();  // what is left of the last tick's time
    file_.close();
  }

  void summarize(Summary& summary) const {
    summary.contact_impulse = sum_;
    for (const auto& [key, load] : loads_.loads()) {
      const std::string name = model_.ragdolls[key.first].name + "/" + key.second;
      summary.peak_force.emplace_back(name, load.peak_force);
      summary.approach_energy.emplace_back(name, load.approach_energy);
    }
  }

 private:
  void tell() {
    const ContactReport report = contacts_->take();
    if (summary_) loads_.add(model_, report.impacts);
    if (file_.wanted()) writeContactRows(model_, report, file_.out());
  }

  const Model& model_;
  RowFile file_;
  Ticks ticks_;
  std::optional<Contacts> contacts_;
  bool summary_ = false;
  Vec3 sum_ = Vec3::Zero();
  RegionLoads loads_;
};

/// Throws Error for a file that would be written twice: one text would be lost.
void checkFiles(const RunOptions& options) {
  std::map<std::filesystem::path, std::string> taken;
  for (const auto& [option, file] :
       {std::pair("--csv", options.csv), std::pair("--contacts", options.contacts),
        std::pair("--imu", options.imu)}) {
    if (file.empty()) continue;
    const auto [other, is_new] = taken.emplace(std::filesystem::weakly_canonical(file), option);
    if (!is_new)
      throw Error(option, "is " + file + ", as " + other->second + " is; it must be another file");
  }
}

int runScene(const RunOptions& options) {
  checked("--seconds", options.seconds, true);
  checked("--rate", options.rate, false);
  checkFiles(options);
  Scene scene = loadScene(options.scene, options.settings);
  const Model model = buildModel(scene);
  for (const std::string& warning : model.warnings) std::cerr << "ragdoll_lab: " << warning << "\n";
  double taken = 0;
  startState(model, &taken);
  if (const std::string text = takenText(taken); !text.empty())
    std::cerr << "ragdoll_lab: " << text << "\n";
  for (const std::string& note : model.notes) {
    const bool more = inShort(note) != note;
    std::cerr << "ragdoll_lab: "
              << (options.pairs || !more ? note : inShort(note) + " (--pairs lists them)") << "\n";
  }

  const double steps = std::ceil(options.seconds / model.solver.step - kRounding);
  if (steps > kMostSteps)
    throw Error("--seconds", "asks for more than 1e12 steps of " + timeText(model.solver.step));
  if (options.rate * std::max(options.seconds, model.solver.step) > kMostSteps)
    throw Error("--rate", "asks for more than 1e12 rows");

  TickWriter rows(model, options);
  ImuWriter imu(model, options.imu);
  WatchedRun world(model);
  imu.begin(world.state());
  ContactWriter contacts(model, options);
  HeadInjuries heads(model);
  rows.write(world.state(), world.time());
  for (double i = 0; i < steps; ++i) {
    contacts.begin(world);
    if (options.summary) heads.begin(world.state());
    world.step();
    contacts.end(world);
    if (options.summary) heads.end(model, world.state());
    rows.write(world.state(), world.time());
    imu.write(world.state());
  }
  rows.close();
  imu.close();
  contacts.close();

  Summary summary = world.summary();
  if (options.summary) {
    contacts.summarize(summary);
    for (const HeadInjuries::Head& head : heads.heads()) {
      summary.hic15.emplace_back(head.name, head.injury.hic15());
      summary.peak_g.emplace_back(head.name, head.injury.peakG());
    }
  }
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
  RunOptions options;
  CommandLine line{"run SCENE [options]", "Steps a scene as fast as possible.", {}};
  auto add = line.options.add_options();
  add("seconds", po::value(&options.seconds)->default_value(10), "Simulated time [s]");
  add("csv", po::value(&options.csv), "Write a row per tick to this file");
  add("rate", po::value(&options.rate)->default_value(60), "Ticks of --csv and --contacts [Hz]");
  add("contacts", po::value(&options.contacts), "Write a row per contact and tick to this file");
  add("imu", po::value(&options.imu), "Write a row per sample of the scene's sensors to this file");
  add("summary", po::bool_switch(&options.summary), "Print what happened as JSON");
  add("pairs", po::bool_switch(&options.pairs),
      "With self_collision: list the pairs of sticks that are left out");
  add("set", po::value(&options.settings),
      "Change a setting, such as solver.step=0.001; may be given again.\nsolver.preset sets all of "
      "the solver but joint_damping");
  return parse(line, words, options.scene) ? runScene(options) : kOk;
}

}  // namespace ragdoll::lab
