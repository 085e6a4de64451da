#include "arguments.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/number_text.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/world/world.h"

namespace ragdoll::lab {

namespace {

/// input: null if the command takes none.
bool parseWords(CommandLine& line, const Words& words, std::string* input) {
  line.options.add_options()("help,h", "Print this and end");
  po::options_description all;
  all.add(line.options);
  po::positional_options_description by_place;
  if (input) {
    all.add_options()("input", po::value(input));
    by_place.add("input", 1);
  }
  try {
    // A negative number is a value, and half an option is a mistake: no short forms, no guessing.
    const int style = po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
    po::variables_map found;
    po::store(po::command_line_parser(words).options(all).positional(by_place).style(style).run(),
              found);
    if (found.count("help")) {
      std::cout << "Usage: ragdoll_lab " << line.usage << "\n\n" << line.about << "\n";
      if (input) std::cout << line.input << " is " << line.input_about << ".\n";
      std::cout << "\n" << line.options;
      return false;
    }
    po::notify(found);
    if (input && !found.count("input"))
      throw Error("", std::string(line.input) + " is missing: " + line.input_about);
  } catch (const po::error& error) {
    throw Error("", std::string(error.what()) + " (see --help)");
  }
  return true;
}

}  // namespace

bool parse(CommandLine& line, const Words& words, std::string& input) {
  return parseWords(line, words, &input);
}

bool parse(CommandLine& line, const Words& words) { return parseWords(line, words, nullptr); }

Scene loadScene(const std::string& path, const Words& settings) {
  Scene scene = ragdoll::loadScene(path);
  const auto follows = [](const auto& spec) { return !spec.frame.empty(); };
  if (std::any_of(scene.obstacles.begin(), scene.obstacles.end(), follows) ||
      std::any_of(scene.pins.begin(), scene.pins.end(), follows))
    World{scene};  // throws what a node would refuse
  fixFrames(scene);
  applySettings(scene, settings);
  return scene;
}

void applySettings(Scene& scene, const Words& settings) {
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      throw Error("--set " + setting, "key=value is expected, such as solver.step=0.001");
    }
    applySetting(scene, setting.substr(0, equals), setting.substr(equals + 1));
  }
}

void dropLimits(Scene& scene) {
  for (RagdollSpec& ragdoll : scene.ragdolls) {
    auto skeleton = std::make_shared<SkeletonSpec>(*ragdoll.skeleton);
    skeleton->joints.clear();
    ragdoll.skeleton = skeleton;
  }
}

double checked(const std::string& option, double value, bool zero_is_right) {
  const bool right = std::isfinite(value) && (value > 0 || (zero_is_right && value == 0));
  if (!right) throw Error(option, "is " + numberText(value) + "; a positive number is expected");
  return value;
}

po::typed_value<double>* positive(const std::string& option, double& value) {
  return po::value<double>()->notifier(
      [&value, option](double given) { value = checked(option, given, false); });
}

int stepsOf(const std::string& option, double seconds, double step) {
  constexpr double kMost = 1e9;
  const double steps = std::max(1.0, std::round(seconds / step));
  if (!(steps <= kMost))
    throw Error(option, "is " + numberText(seconds) + " s, more than 1e9 steps of " +
                            numberText(step) + " s");
  return static_cast<int>(steps);
}

}  // namespace ragdoll::lab
