// ragdoll_lab trade: what every method costs on a scene, and how wrong it is.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "arguments.h"
#include "commands.h"
#include "picture.h"
#include "quantity.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/number_text.h"
#include "survey.h"
#include "survey_text.h"

namespace ragdoll::lab {
namespace {

constexpr const char* kAboutTrade =
    "Measures the trade of speed for accuracy on a scene: every method, at steps that differ by\n"
    "factors of two, with every knob, and the presets, against a reference that is converged by\n"
    "halving its step. A scene with something to touch is chaotic: there all start again and "
    "again\n"
    "from the reference's states and are compared after a short window.\n"
    "Writes a table to stdout, and trade.csv, trade.png and trade.svg to a folder.\n"
    "Cost is CPU time of the steps alone, the median of several runs, each next to a run of "
    "preset\n"
    "thesis, to which the ratio is.\n";

struct TradeOptions {
  std::string scene, folder;
  Words settings;
  bool without_limits = false;
  SurveyOptions survey;
};

void writeFile(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (!file.flush()) throw Error(path, "cannot be written");
}

int trade(TradeOptions& options) {
  Scene scene = loadScene(options.scene, options.settings);
  if (options.without_limits) dropLimits(scene);
  const Model model = buildModel(scene);
  for (const std::string& warning : model.warnings) std::cerr << "ragdoll_lab: " << warning << "\n";
  options.survey = completed(model, options.survey);
  std::error_code ignored;
  std::filesystem::create_directories(options.folder, ignored);
  const std::string base = (std::filesystem::path(options.folder) / "trade").string();
  writeFile(base + ".csv", "");  // a folder that cannot be written to is better known at once

  Survey result;
  {
    Progress progress;
    result = survey(model, options.survey, progress);
  }
  const std::string name = std::filesystem::path(options.scene).stem().string();
  writeFile(base + ".csv", toCsv(result));
  std::cout << toTable(result, name);
  const std::string fault = draw(result, name + ": " + whatError(result), base);
  if (!fault.empty()) std::cerr << "ragdoll_lab: " << fault << "\n";
  if (!std::cout.flush()) throw Error("stdout", "cannot be written");
  return kOk;
}

}  // namespace

int tradeCommand(const Words& words) {
  TradeOptions options;
  CommandLine line{"trade SCENE [options]", kAboutTrade, {}};
  auto add = line.options.add_options();
  add("out", po::value(&options.folder)->default_value("."), "Folder of the files");
  add("horizon", positive("--horizon", options.survey.horizon),
      "Simulated time [s]; default 1, with something to touch 2");
  add("window", positive("--window", options.survey.window),
      "Time [s] after which all start again from the reference; default 0.1 with something to "
      "touch, else the horizon");
  add("dearest",
      po::value(&options.survey.dearest)
          ->default_value(options.survey.dearest, numberText(options.survey.dearest)),
      "CPU time [s] per simulated second beyond which no step is halved");
  add("integrators", po::bool_switch(&options.survey.integrators),
      "Also tell apart the integrators of jakobsen's free motion");
  add("without-limits", po::bool_switch(&options.without_limits), "Let all joints turn freely");
  add("set", po::value(&options.settings),
      "Change a setting, such as gravity=[0,0,-1.62]; may be given again");
  if (!parse(line, words, options.scene)) return kOk;
  checked("--dearest", options.survey.dearest, false);
  return trade(options);
}

}  // namespace ragdoll::lab
