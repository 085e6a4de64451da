// docs/files.md and docs/body.md name the keys of scene and model files: all that are accepted and
// no others, as the reader lists them when it meets one that it does not know.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <regex>
#include <set>
#include <sstream>

#include "errors_of_text.h"

namespace ragdoll {
namespace {

using Keys = std::set<std::string>;

const std::string kDocs = std::string(RAGDOLL_SHARE_DIR) + "/../docs/";

struct Row {
  std::string under;  ///< the last line before the table
  std::string keys, of;
};

std::vector<Row> rows(const std::string& page) {
  std::ifstream file(kDocs + page);
  EXPECT_TRUE(file) << page;
  std::vector<Row> result;
  std::string above, line;
  while (std::getline(file, line)) {
    if (line.empty()) continue;
    if (line[0] != '|') {
      above = line;
      continue;
    }
    std::istringstream cells(line.substr(1));
    Row row{above, "", ""};
    std::getline(cells, row.keys, '|');
    std::getline(cells, row.of, '|');
    result.push_back(row);
  }
  return result;
}

/// The keys in a table; where its second column says of what each is, those of `of`.
Keys told(const std::string& page, const std::string& under, const std::string& of = "") {
  const std::regex key("`([a-z_]+)`");
  Keys keys;
  for (const Row& row : rows(page)) {
    if (row.under != under) continue;
    if (!of.empty() && row.of.find("all") == std::string::npos &&
        row.of.find(of) == std::string::npos)
      continue;
    for (std::sregex_iterator i(row.keys.begin(), row.keys.end(), key), end; i != end; ++i)
      keys.insert((*i)[1]);
  }
  return keys;
}

/// What the reader accepts where `text` has the key nonsense; of a key in degrees and radians one.
Keys accepted(const std::string& text) {
  const std::string error = errorOfText(text), before = "the keys here are ";
  const std::size_t at = error.find(before);
  EXPECT_NE(at, std::string::npos) << error;
  if (at == std::string::npos) return {};
  std::istringstream list(error.substr(at + before.size()));
  Keys keys;
  for (std::string key; std::getline(list >> std::ws, key, ',');) keys.insert(key);
  Keys once = keys;
  for (const std::string& key : keys)
    if (keys.count(key + "_deg") != 0) once.erase(key);
  return once;
}

std::string withModel(const std::string& model) {
  return "ragdolls: [{model: {particles: {a: {position: [0, 0, 0], mass: 1}}" + model + "}}]";
}

TEST(FilesPage, Scene) {
  const std::string ragdoll = "ragdolls: [{model: human}]\n";
  const auto inList = [&](const std::string& key, const std::string& item) {
    return accepted(ragdoll + key + ": [{" + item + ", nonsense: 1}]");
  };
  EXPECT_EQ(told("files.md", "## Scene"), accepted(ragdoll + "nonsense: 1"));
  EXPECT_EQ(told("files.md", "## Ragdoll"), accepted("ragdolls: [{model: human, nonsense: 1}]"));
  const std::pair<std::string, std::string> obstacles[] = {
      {"plane", "type: plane"},
      {"box", "type: box, position: [0, 0, 0], size: [1, 1, 1]"},
      {"sphere", "type: sphere, position: [0, 0, 0], radius: 1"},
      {"capsule", "type: capsule, from: [0, 0, 0], to: [0, 0, 1], radius: 1"}};
  for (const auto& [type, item] : obstacles)
    EXPECT_EQ(told("files.md", "## Obstacle", type), inList("obstacles", item)) << type;
  EXPECT_EQ(told("files.md",
                 "A particle, such as `right_hand` (of the first ragdoll) or "
                 "`ben/right_hand`, held where it starts; or a mapping:"),
            inList("pins", "particle: head"));
  EXPECT_EQ(told("files.md", "## Poke"), inList("pokes", "body: head, force: [0, 0, 0]"));
  EXPECT_EQ(told("files.md", "## Sensor"), inList("sensors", "name: a, type: imu, segment: torso"));
  EXPECT_EQ(told("files.md", "## Solver"), accepted(ragdoll + "solver: {nonsense: 1}"));
}

TEST(FilesPage, Model) {
  EXPECT_EQ(told("files.md", "numbers; below, a lamp on an arm."),
            accepted(withModel(", nonsense: 1")));
  EXPECT_EQ(told("files.md", "A particle:"),
            accepted("ragdolls: [{model: {particles: {a: {position: [0, 0, 0], nonsense: 1}}}}]"));
  const auto segment = [&](const std::string& text) {
    return accepted(withModel(", segments: {s: {" + text + ", nonsense: 1}}"));
  };
  EXPECT_EQ(told("files.md", "A segment:", "bone"), segment("from: a, to: b"));
  EXPECT_EQ(told("files.md", "A segment:", "group"), segment("particles: [a, b, c]"));
  const std::pair<std::string, std::string> joints[] = {
      {"hinge", "axis: [0, 1, 0], range_deg: [0, 1]"},
      {"cone", "axis: [0, 1, 0], half_angle_deg: 1"},
      {"planes", "xy_deg: [0, 1]"}};
  for (const auto& [type, keys] : joints)
    EXPECT_EQ(told("body.md", "The rest of a model file: [files.md](files.md#model).", type),
              accepted(withModel(", joints: {j: {parent: p, child: c, type: " + type + ", " + keys +
                                 ", nonsense: 1}}")))
        << type;
}

TEST(FilesPage, TheLampStandsAndBends) {
  std::ifstream page(kDocs + "files.md");
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  const std::size_t begin = text.find("```yaml\n") + 8, end = text.find("```", begin);
  ASSERT_LT(end, text.size());
  std::istringstream lines(text.substr(begin, end - begin));
  std::string model;
  for (std::string line; std::getline(lines, line);) model += "      " + line + "\n";
  EXPECT_EQ(errorOfText(sceneWithModel(model)), "");
}

}  // namespace
}  // namespace ragdoll
