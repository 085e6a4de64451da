// Sources that the pages name are there: a page that sends its reader to a file that is gone costs
// him more than no page.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>

namespace {

namespace fs = std::filesystem;

/// Every end of every path of a source, from the name alone up: a.h, b/a.h, ...
std::set<std::string> endsOfSources(const fs::path& package) {
  std::set<std::string> ends;
  for (const auto& entry : fs::recursive_directory_iterator(package)) {
    const std::string kind = entry.path().extension().string();
    if (kind != ".h" && kind != ".cpp" && kind != ".py") continue;
    fs::path end;
    const fs::path path = fs::relative(entry.path(), package.parent_path());
    for (auto part = path.end(); part != path.begin();) {
      --part;
      end = end.empty() ? *part : *part / end;
      ends.insert(end.string());
    }
  }
  return ends;
}

TEST(Docs, NameSourcesThatExist) {
  const fs::path package = fs::path(RAGDOLL_SHARE_DIR), root = package.parent_path();
  if (!fs::exists(root / "docs")) GTEST_SKIP() << "the package stands alone, without docs/";
  std::set<std::string> ends = endsOfSources(package);
  if (fs::exists(root / "ragdoll_rviz")) ends.merge(endsOfSources(root / "ragdoll_rviz"));
  const std::regex name("`([a-z0-9_/]+\\.(h|cpp|py))`");
  int names = 0;
  for (const char* page : {"docs/architecture.md", "docs/equations.md", "docs/extremes.md",
                           "docs/trade.md", "README.md"}) {
    std::ifstream in(root / page);
    std::string line;
    for (int number = 1; std::getline(in, line); ++number)
      for (std::sregex_iterator it(line.begin(), line.end(), name), end; it != end; ++it, ++names)
        EXPECT_EQ(ends.count((*it)[1]), 1u)
            << page << ":" << number << " names " << (*it)[1] << ", which is not there";
  }
  EXPECT_GT(names, 50);
}

}  // namespace
