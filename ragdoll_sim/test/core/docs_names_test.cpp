// Sources that the pages name are there, and their links lead somewhere: a page that sends its reader
// to what is gone costs him more than no page.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

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

const fs::path package = fs::path(RAGDOLL_SHARE_DIR), root = package.parent_path();

std::vector<fs::path> pages() {
  std::vector<fs::path> all{root / "README.md"};
  for (const auto& entry : fs::directory_iterator(root / "docs"))
    if (entry.path().extension() == ".md") all.push_back(entry.path());
  return all;
}

/// What a link calls the headings of a page: lower case, without punctuation, - for blanks.
std::set<std::string> headings(const fs::path& page) {
  std::set<std::string> all;
  std::ifstream in(page);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] != '#') continue;
    std::string name;
    for (const char c : line.substr(line.find_first_not_of("# "))) {
      if (c == ' ')
        name += '-';
      else if (std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-')
        name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    all.insert(name);
  }
  return all;
}

/// visit(page, where, match) of every match in the pages; how many there are.
template <class Visit>
int eachMatch(const std::regex& what, const Visit& visit) {
  int count = 0;
  for (const fs::path& page : pages()) {
    std::ifstream in(page);
    std::string line;
    for (int number = 1; std::getline(in, line); ++number)
      for (std::sregex_iterator it(line.begin(), line.end(), what), end; it != end; ++it, ++count)
        visit(page, page.string() + ":" + std::to_string(number), *it);
  }
  return count;
}

TEST(Docs, LinksLeadSomewhere) {
  if (!fs::exists(root / "docs")) GTEST_SKIP() << "the package stands alone, without docs/";
  const std::regex link("\\]\\((?!http)([^)#\\s]*)(#([^)\\s]+))?\\)");
  const auto leads = [](const fs::path& page, const std::string& where, const std::smatch& found) {
    const std::string to = found[1], heading = found[3];
    const fs::path file = to.empty() ? page : page.parent_path() / to;
    EXPECT_TRUE(fs::exists(file)) << where << " leads to " << to;
    EXPECT_TRUE(heading.empty() || headings(file).count(heading) == 1)
        << where << " leads to " << to << "#" << heading;
  };
  EXPECT_GT(eachMatch(link, leads), 100);
}

TEST(Docs, NameSourcesThatExist) {
  if (!fs::exists(root / "docs")) GTEST_SKIP() << "the package stands alone, without docs/";
  std::set<std::string> ends = endsOfSources(package);
  if (fs::exists(root / "ragdoll_rviz")) ends.merge(endsOfSources(root / "ragdoll_rviz"));
  const std::regex name("`([a-z0-9_/]+\\.(h|cpp|py))`");
  const auto is_there = [&](const fs::path&, const std::string& where, const std::smatch& found) {
    EXPECT_EQ(ends.count(found[1]), 1u) << where << " names " << found[1] << ", which is not there";
  };
  EXPECT_GT(eachMatch(name, is_there), 50);
}

/// visit(line) of every line of the file.
template <class Visit>
void eachLine(const fs::path& file, const Visit& visit) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) visit(line);
}

TEST(Docs, ListTheSourcesThatAreCited) {
  if (!fs::exists(root / "docs")) GTEST_SKIP() << "the package stands alone, without docs/";
  const std::regex listed("^(- )?\\[([A-Z][A-Za-z-]+(19|20)[0-9]{2})\\] [A-Z]");
  const std::regex cited("(\\[|; )([A-Z][A-Za-z-]+(19|20)[0-9]{2})[\\],;]");
  std::set<std::string> known;
  std::smatch found;
  for (const fs::path& page : pages())
    eachLine(page, [&](const std::string& line) {
      if (std::regex_search(line, found, listed)) known.insert(found[2]);
    });
  int count = 0;
  const auto check = [&](const fs::path& file) {
    eachLine(file, [&](const std::string& line) {
      for (std::sregex_iterator it(line.begin(), line.end(), cited), end; it != end; ++it, ++count)
        EXPECT_EQ(known.count((*it)[2]), 1u) << file.string() << " cites " << (*it)[2];
    });
  };
  for (const fs::path& page : pages()) check(page);
  for (const auto& entry : fs::recursive_directory_iterator(package))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp") check(entry.path());
  EXPECT_GT(count, 80);
}

}  // namespace
