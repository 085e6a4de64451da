// ragdoll_lab: the simulator's core without ROS, for measuring and for scripts.
// Exit status: 0 ok, 1 a check failed, 2 bad input (one line on stderr says what).
#include <exception>
#include <iomanip>
#include <iostream>

#include "commands.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll::lab {
namespace {

struct Command {
  const char *name, *about;
  int (*run)(const Words& words);
};

constexpr Command kCommands[] = {
    {"run", "Step a scene as fast as possible", runCommand},
    {"trade", "Measure speed against accuracy on a scene", tradeCommand},
    {"tune", "Find the solver setting for an error or a cost", tuneCommand},
    {"crowd", "Measure what many bodies cost", crowdCommand},
    {"falls", "Write labelled falls with IMUs, without ROS", fallsCommand},
    {"features", "Measure what each feature of a scene costs", featuresCommand},
    {"extremes", "Run the stability matrix", extremesCommand},
#ifdef RAGDOLL_WITH_ROS
    {"replay", "Simulate a recorded run again and compare it bit for bit", replayCommand},
#endif
};

void printHelp() {
  std::cout << "The ragdoll simulator without ROS.\n"
               "Usage: ragdoll_lab SUBCOMMAND ... (each has its own --help)\n\n";
  for (const Command& command : kCommands) {
    std::cout << "  " << std::left << std::setw(10) << command.name << command.about << "\n";
  }
  std::cout << "\nExit status: 0 ok, 1 a check failed, 2 bad input.\n";
}

int dispatch(const Words& words) {
  if (words.empty()) throw Error("", "a subcommand is missing (see --help)");
  if (words[0] == "--help" || words[0] == "-h") {
    printHelp();
    return kOk;
  }
  std::string names;
  for (const Command& command : kCommands) {
    if (words[0] == command.name) return command.run({words.begin() + 1, words.end()});
    names += (names.empty() ? "" : ", ") + std::string(command.name);
  }
  throw Error("", "there is no subcommand '" + words[0] + "'; there are " + names);
}

}  // namespace
}  // namespace ragdoll::lab

int main(int argc, char** argv) {
  using namespace ragdoll;
  try {
    return lab::dispatch({argv + 1, argv + argc});
  } catch (const Error& error) {
    std::cerr << "ragdoll_lab: " << error.what() << "\n";
    return lab::kBadInput;
  } catch (const std::exception& error) {
    std::cerr << "ragdoll_lab: internal error: " << error.what() << "\n";
    return lab::kCheckFailed;
  }
}
