// ragdoll_lab tune: the solver setting for an error or a cost, measured on the user's scene.
#include <filesystem>
#include <iostream>

#include "arguments.h"
#include "commands.h"
#include "quantity.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/number_text.h"
#include "tuning.h"

namespace ragdoll::lab {
namespace {

constexpr int kMostStarts = 1000;

constexpr const char* kAboutTune =
    "Finds the solver setting for a scene, by measuring on it: the cheapest one whose error is at\n"
    "most --error, or the most accurate one that costs at most --budget. Prints a section "
    "`solver:`\n"
    "to paste into the scene, with what was measured as comments.\n"
    "  error   RMS distance of the particles from a converged reference: after 1 s, or, with\n"
    "          something to touch, after 0.1 s, mean over windows that start from the reference;\n"
    "          of the scene and of other starts (--starts) the largest, times three: what to\n"
    "          expect of any\n"
    "  budget  CPU time of the steps of the whole scene per simulated second, on this machine\n"
    "Exit status 1, and what comes closest, where the target cannot be met.\n";

struct TuneOptions {
  std::string scene, error, budget;
  Words settings;
  bool without_limits = false;
  int starts = 3;
  SurveyOptions survey;
};

Target targetOf(const TuneOptions& options) {
  if (options.error.empty() == options.budget.empty())
    throw Error("", "one of --error and --budget is expected, such as --error 1mm");
  Target target;
  if (!options.error.empty()) target.error = parseLength("--error", options.error);
  if (!options.budget.empty()) target.budget = parseTime("--budget", options.budget);
  return target;
}

std::string complaint(const Choice& choice, const Target& target) {
  if (target.error == 0)
    return "the cheapest setting costs " + timeText(choice.measurement.cost) +
           " per simulated second, more than " + timeText(target.budget);
  if (choice.reference.uncertainty > target.error)
    return "the reference itself is only sure to " + lengthText(choice.reference.uncertainty) +
           ", so that an error of " + lengthText(target.error) + " cannot be told";
  return "the smallest error found is " + lengthText(choice.measurement.expected) + ", more than " +
         lengthText(target.error);
}

int printTuned(TuneOptions& options) {
  const Target target = targetOf(options);
  Scene scene = loadScene(options.scene, options.settings);
  if (options.without_limits) dropLimits(scene);
  const Model model = buildModel(scene);
  for (const std::string& warning : model.warnings) std::cerr << "ragdoll_lab: " << warning << "\n";
  options.survey = completed(model, options.survey);
  Choice choice;
  {
    Progress progress;
    const auto others = otherStarts(scene, options.starts, target, options.survey, progress);
    choice = tune(model, target, options.survey, others, progress);
  }
  std::cout << toText(choice, target, std::filesystem::path(options.scene).stem().string());
  if (!std::cout.flush()) throw Error("stdout", "cannot be written");
  if (choice.met) return kOk;
  std::cerr << "ragdoll_lab: the target cannot be met: " << complaint(choice, target) << "\n";
  return kCheckFailed;
}

}  // namespace

int tuneCommand(const Words& words) {
  TuneOptions options;
  options.survey.dearest = 0.1;
  CommandLine line{"tune SCENE (--error LENGTH | --budget TIME) [options]", kAboutTune, {}};
  auto add = line.options.add_options();
  add("error", po::value(&options.error), "Largest error, in um, mm, cm or m, such as 1mm");
  add("budget", po::value(&options.budget),
      "Most CPU time per simulated second, in us, ms or s, such as 50us");
  add("horizon", positive("--horizon", options.survey.horizon),
      "Simulated time [s]; default 1, with something to touch 2");
  add("window", positive("--window", options.survey.window),
      "Time [s] after which all start again from the reference; default 0.1 with something to "
      "touch, else the horizon");
  add("dearest",
      po::value(&options.survey.dearest)
          ->default_value(options.survey.dearest, numberText(options.survey.dearest)),
      "CPU time [s] per simulated second beyond which no step is halved");
  add("starts", po::value(&options.starts)->default_value(options.starts),
      "Other starts, with other velocities, that the answer is measured on, too; 0: this run "
      "alone");
  add("without-limits", po::bool_switch(&options.without_limits), "Let all joints turn freely");
  add("set", po::value(&options.settings),
      "Change a setting, such as gravity=[0,0,-1.62]; may be given again");
  if (!parse(line, words, options.scene)) return kOk;
  if (options.starts < 0 || options.starts > kMostStarts)
    throw Error("--starts", "is " + std::to_string(options.starts) + "; a number from 0 to " +
                                std::to_string(kMostStarts) + " is expected");
  checked("--dearest", options.survey.dearest, false);
  return printTuned(options);
}

}  // namespace ragdoll::lab
