#include "guard_cost.h"

#include <algorithm>

#include "extreme_scenes.h"
#include "extreme_verdict.h"
#include "format.h"
#include "measurement.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/start_state.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::lab {
namespace {

constexpr int kPiece = 20;        ///< steps that are timed together
constexpr double kSeconds = 1.5;  ///< simulated: until a body lies

/// One world that is stepped in pieces.
class PieceRunner {
 public:
  PieceRunner(const Model& model, bool guarded) : model_(model), inputs_(startInputs(model)) {
    workspace_.setGuard(guarded);
  }

  void restart() {
    state_ = startState(model_);
    acted = 0;
  }

  /// [s] CPU per step.
  double piece() {
    const double begin = cpuTime();
    for (int i = 0; i < kPiece; ++i) {
      const StepReport report = step(model_, inputs_, workspace_, state_);
      acted += report.guarded + report.limited > 0;
    }
    return (cpuTime() - begin) / kPiece;
  }

  int acted = 0;

 private:
  const Model& model_;
  Inputs inputs_;
  Workspace workspace_;
  State state_;
};

/// What two worlds cost, piece by piece in turn; `method` of the result is left to the caller.
GuardCost compare(PieceRunner& plain, PieceRunner& other, double step, int rounds) {
  std::vector<double> without, with, ratios;
  const int pieces = std::max(1, static_cast<int>(kSeconds / step / kPiece));
  for (int round = 0; round < rounds; ++round) {
    plain.restart();
    other.restart();
    double sum_without = 0, sum_with = 0;
    for (int p = 0; p < pieces; ++p) {
      const bool first = (round + p) % 2 == 0;  // neither is always the one with the warm cache
      if (first) sum_without += plain.piece();
      sum_with += other.piece();
      if (!first) sum_without += plain.piece();
    }
    without.push_back(sum_without / pieces);
    with.push_back(sum_with / pieces);
    ratios.push_back(sum_with / sum_without);
  }
  GuardCost cost;
  cost.plain = median(without);
  cost.guarded = median(with);
  cost.ratio = median(ratios);
  cost.acted = other.acted;
  return cost;
}

GuardCost costOf(const std::string& name, const ExtremeMethod& method, int rounds) {
  Scene scene = ragdoll::loadScene(name);
  scene.solver = method.solver;
  scene.solver.sleep = false;
  scene.pokes.clear();
  const Model model = buildModel(scene);
  PieceRunner plain(model, false), guarded(model, true);
  GuardCost cost = compare(plain, guarded, model.solver.step, rounds);
  cost.scene = name;
  cost.method = method.name;
  return cost;
}

/// A heavy chain against a light one, both guarded.
GuardCost costOfLoad(const std::string& name, const Scene& light, const Scene& heavy,
                     const ExtremeMethod& method, double step, int rounds) {
  std::vector<Model> models;
  for (Scene scene : {light, heavy}) {
    scene.solver = method.solver;
    scene.solver.step = step;
    scene.solver.sleep = false;
    models.push_back(buildModel(scene));
  }
  PieceRunner without(models[0], true), with(models[1], true);
  GuardCost cost = compare(without, with, step, rounds);
  cost.scene = name;
  cost.method = method.name;
  return cost;
}

/// 10 links of 0.1 kg at 1/60 s, tilted: with nothing below them, and with 100 kg.
GuardCost loadedChain(const ExtremeMethod& method, int rounds) {
  std::vector<double> masses(11, 0.1);
  const Scene light = chainScene(masses, 0.1, 0.5);
  masses.back() = 100;
  return costOfLoad("100 kg chain", light, chainScene(masses, 0.1, 0.5), method, 1.0 / 60, rounds);
}

/// The matrix's chains of a mass ratio, hung and swung, against those of 1:1.
void addMassRatios(const ExtremeMethod& method, int rounds, std::vector<GuardCost>& costs) {
  for (const double ratio : {1e3, 1e4, 1e5, 1e6})
    for (const double tilt : {0.0, kMassRatioTilt})
      costs.push_back(costOfLoad("1:" + shortNumber(ratio) + (tilt > 0 ? ", swung" : ", hung"),
                                 massRatioChain(1, tilt), massRatioChain(ratio, tilt), method,
                                 method.solver.step, rounds));
}

}  // namespace

std::vector<GuardCost> guardCosts(int rounds) {
  std::vector<GuardCost> costs;
  for (const ExtremeMethod& method : extremeMethods())
    for (const char* scene : {"fall", "stairs", "weightless"})
      costs.push_back(costOf(scene, method, rounds));
  for (const ExtremeMethod& method : extremeMethods()) costs.push_back(loadedChain(method, rounds));
  for (const ExtremeMethod& method : extremeMethods())
    if (method.is_default) addMassRatios(method, rounds, costs);
  return costs;
}

std::string toTable(const std::vector<GuardCost>& costs) {
  std::string text =
      "scene           method      us/step plain  guarded  ratio  steps in which it acted\n";
  for (const GuardCost& c : costs)
    text += format("%-15s %-10s %14.2f %8.2f %6.3f  %d\n", c.scene.c_str(), c.method.c_str(),
                   1e6 * c.plain, 1e6 * c.guarded, c.ratio, c.acted);
  return text;
}

std::string toMarkdown(const std::vector<GuardCost>& costs) {
  std::string text =
      "\n| scene | method | us/step plain | guarded | ratio | steps in which it acted |\n"
      "|---|---|---|---|---|---|\n";
  for (const GuardCost& c : costs)
    text += format("| %s | %s | %.1f | %.1f | %.3f | %d |\n", c.scene.c_str(), c.method.c_str(),
                   1e6 * c.plain, 1e6 * c.guarded, c.ratio, c.acted);
  return text;
}

}  // namespace ragdoll::lab
