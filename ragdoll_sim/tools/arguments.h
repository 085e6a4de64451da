// The command line of one subcommand: options by name, one input by place, --help.
#pragma once

#include <boost/program_options.hpp>
#include <string>

#include "commands.h"
#include "ragdoll_sim/core/scene.h"

namespace ragdoll::lab {

namespace po = boost::program_options;

struct CommandLine {
  const char* usage;  ///< "run SCENE [options]"
  const char* about;  ///< what the command does, a line or a few
  po::options_description options;
  const char* input = "SCENE";  ///< what stands without a name, as `usage` calls it
  const char* input_about = "a file, or the name of a scene such as fall";
};

/// Reads the words into what the options are bound to, and the word without a name into `input`.
/// Returns false when --help was asked for and has been printed. Throws Error.
bool parse(CommandLine& line, const Words& words, std::string& input);

/// The same for a command that takes no scene.
bool parse(CommandLine& line, const Words& words);

/// The scene with the settings ("solver.step=0.001") that --set gave, frames fixed: these commands
/// know no TF. Throws Error.
Scene loadScene(const std::string& path, const Words& settings);

/// The same for a scene that is there.
void applySettings(Scene& scene, const Words& settings);

/// Lets all joints turn freely.
void dropLimits(Scene& scene);

/// `value`, which has to be finite and positive (or zero, if that is right). Throws Error.
double checked(const std::string& option, double value, bool zero_is_right);

/// An option that may be left out, `value` as it is then; where it is given it has to be finite and
/// positive.
po::typed_value<double>* positive(const std::string& option, double& value);

/// Whole steps in so many seconds, at least one. Throws Error that names the option if there are
/// more than 1e9.
int stepsOf(const std::string& option, double seconds, double step);

}  // namespace ragdoll::lab
