// The subcommands of ragdoll_lab, a file each. A line in main's table is all that a new one needs.
#pragma once

#include <string>
#include <vector>

namespace ragdoll::lab {

enum ExitStatus {
  kOk = 0,
  kCheckFailed = 1,  ///< the run itself went wrong, or a check was not met
  kBadInput = 2,     ///< a file, an option or a value that cannot be used
};

using Words = std::vector<std::string>;  ///< what the command line has after the subcommand

int crowdCommand(const Words& words);
int extremesCommand(const Words& words);
int fallsCommand(const Words& words);
int featuresCommand(const Words& words);
int replayCommand(const Words& words);  ///< only where ROS is
int runCommand(const Words& words);
int tradeCommand(const Words& words);
int tuneCommand(const Words& words);

}  // namespace ragdoll::lab
