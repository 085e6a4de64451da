// The rooms of src/core and the folders around it: #include arrows run one way, so that each can be
// read with what comes before it and nothing else. docs/architecture.md has the picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "support/starts_with.h"

namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

/// A room includes itself and those before it.
const Strings kRooms{"base",      "model",  "limits",     "contact", "linear", "loading",
                     "mechanics", "direct", "relaxation", "fast",    "step"};

/// Likewise the folders of src/ and include/ragdoll_sim/; tools/ comes after them.
const Strings kFolders{"core", "io", "body", "world", "falls", "ros"};

/// Public headers lie flat; one with a source of the same name is of its room, the rest are here.
const std::map<std::string, std::string> kHeaderOnly{
    {"error", "base"},  {"histogram", "base"}, {"names", "base"},  {"types", "base"},
    {"limit", "model"}, {"scene", "model"},    {"state", "model"}, {"step_report", "model"}};

struct Include {
  std::string from, to;  ///< relative to the package; to: as written
  int line;
};

std::string where(const Include& i) {
  return i.from + ":" + std::to_string(i.line) + " includes " + i.to;
}

/// The parts of a path: "src/core/direct/body.h" -> src, core, direct, body.h.
Strings partsOf(const fs::path& path) {
  Strings parts;
  for (const fs::path& part : path) parts.push_back(part.string());
  return parts;
}

int placeOf(const Strings& order, const std::string& name) {
  const auto it = std::find(order.begin(), order.end(), name);
  return it == order.end() ? -1 : static_cast<int>(it - order.begin());
}

const fs::path kRoot = RAGDOLL_SHARE_DIR;

Strings filesUnder(const std::string& folder) {
  Strings files;
  if (!fs::exists(kRoot / folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
    const std::string kind = entry.path().extension().string();
    if (kind == ".h" || kind == ".cpp") files.push_back(fs::relative(entry.path(), kRoot).string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The #include "..." lines of the files below a folder.
std::vector<Include> includesUnder(const std::string& folder) {
  std::vector<Include> all;
  for (const std::string& file : filesUnder(folder)) {
    std::ifstream in(kRoot / file);
    std::string text;
    for (int line = 1; std::getline(in, text); ++line) {
      if (!startsWith(text, "#include \"")) continue;
      const std::size_t begin = text.find('"') + 1;
      all.push_back({file, text.substr(begin, text.find('"', begin) - begin), line});
    }
  }
  return all;
}

/// The room of each public header of the core, by stem.
std::map<std::string, std::string> roomsOfPublicHeaders() {
  std::map<std::string, std::string> rooms = kHeaderOnly;
  for (const std::string& file : filesUnder("src/core")) {
    const std::string stem = fs::path(file).stem().string();
    if (fs::path(file).extension() == ".cpp" &&
        fs::exists(kRoot / ("include/ragdoll_sim/core/" + stem + ".h")))
      rooms[stem] = partsOf(file)[2];
  }
  return rooms;
}

/// The room of a file of the core, or of an include of one; empty: it is none.
std::string roomOf(const std::string& path) {
  static const std::map<std::string, std::string> rooms = roomsOfPublicHeaders();
  const Strings parts = partsOf(path);
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    if (parts[i] != "core") continue;
    if (i + 2 < parts.size()) return parts[i + 1];  // src/core/<room>/, "core/<room>/"
    const auto it = rooms.find(fs::path(path).stem().string());
    return it == rooms.end() ? "" : it->second;
  }
  return "";
}

/// The folder of an include: "ragdoll_sim/io/csv.h", "io/reader.h" -> io.
std::string folderOf(const std::string& include) {
  const Strings parts = partsOf(include);
  const std::size_t first = parts[0] == "ragdoll_sim" ? 1 : 0;
  return first + 1 < parts.size() && placeOf(kFolders, parts[first]) >= 0 ? parts[first] : "";
}

std::vector<Include> includesOfCore() {
  std::vector<Include> all = includesUnder("src/core");
  const std::vector<Include> flat = includesUnder("include/ragdoll_sim/core");
  all.insert(all.end(), flat.begin(), flat.end());
  return all;
}

TEST(Rooms, ArrowsBetweenThemRunOneWay) {
  const std::vector<Include> all = includesOfCore();
  ASSERT_GT(all.size(), 100u);  // it has found the source
  for (const Include& i : all) {
    if (folderOf(i.to) != "core") continue;
    const int from = placeOf(kRooms, roomOf(i.from)), to = placeOf(kRooms, roomOf(i.to));
    EXPECT_GE(from, 0) << i.from << " is of no room";
    EXPECT_GE(to, 0) << where(i) << ", which is of no room";
    EXPECT_LE(to, from) << where(i) << ": an arrow back from " << roomOf(i.from) << " to "
                        << roomOf(i.to);
  }
}

TEST(Rooms, EachPublicHeaderHasOne) {
  std::set<std::string> stems;
  for (const std::string& file : filesUnder("include/ragdoll_sim/core")) {
    stems.insert(fs::path(file).stem().string());
    EXPECT_GE(placeOf(kRooms, roomOf(file)), 0) << file << " is of no room: name it in kHeaderOnly";
  }
  for (const auto& [stem, room] : kHeaderOnly)
    EXPECT_EQ(stems.count(stem), 1u) << "kHeaderOnly has a " << stem << ".h that is not there";
}

TEST(Rooms, ArrowsBetweenFoldersRunOneWay) {
  for (const std::string& folder : kFolders)
    for (const std::string& place : {"src/" + folder, "include/ragdoll_sim/" + folder})
      for (const Include& i : includesUnder(place)) {
        const std::string to = folderOf(i.to);
        if (to.empty()) continue;
        EXPECT_LE(placeOf(kFolders, to), placeOf(kFolders, folder)) << where(i);
      }
}

TEST(Rooms, WhatIsAroundTheCoreIncludesItsPublicHeaders) {
  for (const std::string folder :
       {"src/io", "src/body", "src/world", "src/ros", "tools", "include", "examples"})
    for (const Include& i : includesUnder(folder)) {
      EXPECT_FALSE(startsWith(i.to, "core/")) << where(i) << ", which is private to the core";
      EXPECT_EQ(i.to.find("../"), std::string::npos) << where(i);
    }
}

TEST(Rooms, PublicHeadersOfTheCoreAreUsedOutsideIt) {
  const std::string folder = "ragdoll_sim/core/";
  std::set<std::string> used;
  for (const std::string place :
       {"src/io", "src/body", "src/world", "src/ros", "tools", "include/ragdoll_sim/io",
        "include/ragdoll_sim/body", "include/ragdoll_sim/world", "include/ragdoll_sim/ros"})
    for (const Include& i : includesUnder(place)) used.insert(i.to);
  const std::vector<Include> own = includesUnder("include/" + folder);
  for (std::size_t before = 0; before != used.size();) {  // what a used one includes is used, too
    before = used.size();
    for (const Include& i : own)
      if (used.count(i.from.substr(std::string("include/").size())) > 0) used.insert(i.to);
  }
  for (const std::string& file : filesUnder("include/" + folder))
    EXPECT_EQ(used.count(file.substr(std::string("include/").size())), 1u)
        << file << " is used by the core alone: its place is beside its source";
}

}  // namespace
