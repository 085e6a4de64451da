// ragdoll_lab extremes: the stability matrix, tests x methods, each cell judged by laws.
#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "arguments.h"
#include "commands.h"
#include "extreme_text.h"
#include "guard_cost.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll::lab {
namespace {

constexpr const char* kAboutExtremes =
    "Runs scenes at the extremes by every method and judges each run by what must hold: finite\n"
    "numbers, no energy but work, sticks whole within a second, nothing in the floor or through a\n"
    "thin box, rest. Prints the matrix: ok, or the laws that were broken. Exit status 1 if the\n"
    "default method breaks one.";

std::string textOf(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw Error(path, "cannot be read");
  return std::string(std::istreambuf_iterator<char>(file), {});
}

/// Prints what was run, and puts it into the document between its marks.
class Report {
 public:
  /// Throws Error if there is no such document: now, not in an hour. No path: no document.
  Report(std::string path, std::string mark) : path_(std::move(path)), mark_(std::move(mark)) {
    if (path_.empty()) return;
    document_ = textOf(path_);
    withTables(document_, mark_, "", path_);
  }

  template <class Results>
  void write(const Results& results) const {
    std::cout << toTable(results);
    if (!path_.empty()) {
      std::ofstream file(path_);
      file << withTables(document_, mark_, toMarkdown(results), path_);
      if (!file.flush()) throw Error(path_, "cannot be written");
    }
    if (!std::cout.flush()) throw Error("stdout", "cannot be written");
  }

 private:
  std::string path_, mark_, document_;
};

int extremes(const MatrixOptions& options, const Report& report) {
  Matrix matrix;
  {
    Progress progress;
    matrix = runMatrix(options, progress);
  }
  report.write(matrix);
  return matrix.defaultKeepsAll() ? kOk : kCheckFailed;
}

}  // namespace

int extremesCommand(const Words& words) {
  MatrixOptions options;
  std::string path;
  constexpr int kNotAsked = std::numeric_limits<int>::min();
  int rounds = kNotAsked;
  long long seed = 0;
  bool random_only = false;
  CommandLine line{"extremes [options]", kAboutExtremes, {}};
  auto add = line.options.add_options();
  add("quick", po::bool_switch(&options.quick), "A part of the tests");
  add("random", po::value(&options.random)->default_value(1000), "Number of random scenes");
  add("piles", po::value(&options.piles)->default_value(100),
      "Number of random scenes of two to four bodies that meet");
  add("driven", po::value(&options.driven)->default_value(200),
      "Number of random scenes in which obstacles and a pin are driven");
  add("random-only", po::bool_switch(&random_only), "Random scenes and piles alone");
  add("seed", po::value(&seed)->default_value(0), "Of the first random scene and the first pile");
  add("only", po::value(&options.only),
      "Only tests whose name contains this, such as \"step: 0.1\"; --random 0 --piles 0 --driven 0 "
      "leave out the random scenes");
  add("method", po::value(&options.method), "Only this one: jakobsen, fast, shake or rk");
  add("guard-cost", po::value(&rounds)->implicit_value(41),
      "Instead: what the step guard costs on shipped scenes, with and without it in turn so many "
      "times");
  add("write", po::value(&path),
      "Put the tables into this file, between its lines <!-- extremes --> and <!-- /extremes -->; "
      "with --random-only its lines <!-- random-only --> and so on, and so for --guard-cost");
  if (!parse(line, words)) return kOk;
  for (const auto& [name, scenes] :
       {std::pair("--random", options.random), {"--piles", options.piles}, {"--driven", options.driven}})
    if (scenes < 0) throw Error(name, "is negative; a number of scenes is expected");
  if (seed < 0 || seed > std::numeric_limits<std::uint32_t>::max() -
                             std::int64_t{std::max({options.random, options.piles, options.driven})})
    throw Error("--seed",
                std::to_string(seed) + " is none: 0 to 2^32 less the number of scenes is");
  options.seed = static_cast<std::uint32_t>(seed);
  if (rounds != kNotAsked) {
    if (rounds < 1)
      throw Error("--guard-cost", std::to_string(rounds) + " rounds; at least one is expected");
    const Report report(path, "guard-cost");
    report.write(guardCosts(rounds));
    return kOk;
  }
  options.tests = !random_only;
  return extremes(options, Report(path, random_only ? "random-only" : "extremes"));
}

}  // namespace ragdoll::lab
