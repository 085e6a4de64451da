// The golden list as text: what build wrote it, then a line a case.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "golden_run.h"

namespace ragdoll::golden {

/// What bits may depend on besides the source: "compiler" -> "gcc 12.2.0". In the file's order.
using Build = std::vector<std::pair<std::string, std::string>>;

/// Of the program that runs, on the processor that it runs on.
Build thisBuild();

struct List {
  Build build;
  std::map<std::string, Outcome> cases;  ///< by name
};

/// Throws std::runtime_error that names file and line.
List readList(const std::string& path);
void writeList(const List& list, const std::string& path);

/// "compiler: gcc 12.2.0, here clang 14.0.6": a line for each that differs, "" if none does.
std::string differences(const Build& recorded, const Build& here);

/// Cases that differ, are missing, or are new; the first ten of them, then how many more, by
/// groups. "" if there is none.
std::string differences(const List& expected, const List& got);

}  // namespace ragdoll::golden
