// Same source, same scene: same bits. golden.txt holds what some 700 runs come to, and this test
// tells when one of them changes. A list says nothing about right or wrong; the laws do.
//
// Where bits are MEANT to change, one command writes the list anew; the commit says why:
//   cmake --build build --target golden_list      (or: golden_test --write [FILE])
//
// Bits belong to a compiler, a C library and a family of processors, which the list names. Where
// this build is another and its bits differ, the test says so and compares two builds: the
// revision that the list was written for, built by two_builds.sh with this compiler for this
// processor, against this one. Without a history (an archive, a shallow clone) nothing is there
// to compare with; then this source is built a second time with -O1, which shows at least that
// the bits are the source's and not the optimizer's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <iostream>

#include "golden_cases.h"
#include "golden_list.h"

namespace ragdoll::golden {
namespace {

const std::string kFolder = std::string(RAGDOLL_SHARE_DIR) + "/test/golden/";
const std::string kList = kFolder + "golden.txt";
const std::string kHowToChange =
    "If bits were MEANT to change, write the list anew and say in the commit why:\n"
    "  cmake --build " RAGDOLL_GOLDEN_BUILD_DIR " --target golden_list\n";

/// Sanitizers and -O0 are ten times as slow: there only a part of the cases is run.
int stride() {
#ifdef __OPTIMIZE__
  return std::getenv("RAGDOLL_SANITIZED") ? 10 : 1;
#else
  return 10;
#endif
}

/// Runs the cases and prints how long groups of them and the longest took.
List runCases(int every) {
  List list;
  list.build = thisBuild();
  std::vector<std::pair<std::string, double>> seconds;  // per group
  std::vector<std::pair<double, std::string>> longest;
  const std::vector<Case> cases = allCases();
  for (std::size_t i = 0; i < cases.size(); i += every) {
    const Case& c = cases[i];
    const std::clock_t start = std::clock();  // of the processor: others may run beside
    if (!list.cases.emplace(c.name, c.run()).second)
      throw std::runtime_error("two cases are called '" + c.name + "'");
    const double took = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    if (seconds.empty() || seconds.back().first != c.group) seconds.emplace_back(c.group, 0);
    seconds.back().second += took;
    longest.emplace_back(took, c.name);
  }
  for (const auto& [group, took] : seconds) std::cout << group << ": " << took << " s\n";
  std::sort(longest.rbegin(), longest.rend());
  longest.resize(std::min<std::size_t>(longest.size(), 5));
  for (const auto& [took, name] : longest) std::cout << "  " << took << " s " << name << "\n";
  return list;
}

/// The cases of `list` that are in `part` too.
List partOf(const List& list, const List& part) {
  List result{list.build, {}};
  for (const auto& [name, outcome] : list.cases)
    if (part.cases.count(name) > 0) result.cases[name] = outcome;
  return result;
}

/// Builds the revision of the list, or this source with -O1, and compares.
void compareTwoBuilds(const List& here) {
  const std::string other = RAGDOLL_GOLDEN_BUILD_DIR "/golden/other.txt";
  const std::string command =
      "bash '" + kFolder + "two_builds.sh' '" RAGDOLL_GOLDEN_BUILD_DIR "' '" + other + "'";
  std::cout << command << std::endl;
  ASSERT_EQ(std::system(command.c_str()), 0) << "the second build failed";
  const List built = readList(other);
  const std::string changed = differences(stride() == 1 ? built : partOf(built, here), here);
  if (changed.empty())
    std::cout << "The two builds have the same bits.\n";
  else
    ADD_FAILURE() << "Expected is what the other build came to.\n" << changed << kHowToChange;
}

TEST(Golden, BitsAreThoseOfTheList) {
  const List expected = readList(kList);
  const List got = runCases(stride());
  if (stride() > 1) std::cout << "every tenth case, as this build is slow\n";
  const std::string other_build = differences(expected.build, got.build);
  const std::string changed = differences(stride() == 1 ? expected : partOf(expected, got), got);
  if (!other_build.empty())
    std::cout << "The list is of another build:\n"
              << other_build
              << (changed.empty() ? "Its bits are those of the list even so.\n"
                                  : "Its bits differ, so two builds are compared.\n" + changed);
  if (!other_build.empty() && !changed.empty())
    compareTwoBuilds(got);
  else if (!changed.empty())
    ADD_FAILURE() << changed << kHowToChange;
}

TEST(Golden, TheListReachesEveryFieldOfTheReport) {
  std::array<std::uint64_t, kSumCount> sums{};
  for (const auto& [name, outcome] : readList(kList).cases)
    for (int i = 0; i < kSumCount; ++i) sums[i] += outcome.sums[i];
  for (int i = 0; i < kSumCount; ++i) EXPECT_GT(sums[i], 0u) << kSums[i];
}

}  // namespace

int write(const std::string& path) {
  try {
    writeList(runCases(1), path);
    std::cout << "written: " << path << "\n";
    return 0;
  } catch (const std::exception& e) {
    std::cerr << "golden_test: " << e.what() << "\n";
    return 1;
  }
}

}  // namespace ragdoll::golden

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "--write")
    return ragdoll::golden::write(argc > 2 ? argv[2] : ragdoll::golden::kList);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
