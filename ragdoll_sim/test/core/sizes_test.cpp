// The direct methods stay readable: no header over 150 lines, no class over 20 methods, no function
// over 40 lines. Read off the layout that clang-format gives.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/starts_with.h"

namespace {

namespace fs = std::filesystem;

constexpr int kMostHeaderLines = 150, kMostMethods = 20, kMostFunctionLines = 40;

std::vector<std::string> linesOf(const fs::path& path) {
  std::ifstream in(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

bool isTypeAt(const std::string& line) {
  return startsWith(line, "class ") || startsWith(line, "struct ") || startsWith(line, "enum ") ||
         startsWith(line, "union ");
}

/// Whether a function of a namespace, or a part of its signature, begins in this line.
bool isFunctionAt(const std::string& line) {
  return !line.empty() && (std::isalpha(static_cast<unsigned char>(line[0])) != 0) &&
         !startsWith(line, "namespace") && !startsWith(line, "using") &&
         !startsWith(line, "constexpr") && !isTypeAt(line) && line.find('(') != std::string::npos;
}

struct Long {
  std::string what;
  int size;
};

/// Functions from their first line to the brace that closes them in column 0.
std::vector<Long> functionsOf(const std::vector<std::string>& lines) {
  std::vector<Long> found;
  int first = -1;
  for (int i = 0; i < static_cast<int>(lines.size()); ++i) {
    const std::string& line = lines[i];
    if (first < 0 && isFunctionAt(line)) first = i;
    if (first < 0) continue;
    if (line == "}") {
      found.push_back({lines[first], i - first + 1});
      first = -1;
    } else if (line.empty() || line[0] == ' ') {
      continue;
    } else if (line.back() == ';' || line.back() == '}') {  // a declaration, or all in one line
      first = -1;
    }
  }
  return found;
}

/// Classes of a namespace, with how many of their members have parentheses and are no comment.
std::vector<Long> classesOf(const std::vector<std::string>& lines) {
  std::vector<Long> found;
  bool inside = false;
  for (const std::string& line : lines) {
    if (isTypeAt(line) && !line.empty() && line.back() == '{') {
      inside = true;
      found.push_back({line, 0});
    }
    if (startsWith(line, "}")) inside = false;
    const bool member = line.size() > 2 && startsWith(line, "  ") && line[2] != ' ' &&
                        line[2] != '/' && line[2] != '}';
    if (inside && member && line.substr(0, line.find("//")).find('(') != std::string::npos)
      ++found.back().size;
  }
  return found;
}

std::vector<fs::path> filesOfDirect() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(RAGDOLL_SHARE_DIR) / "src/core/direct"))
    files.push_back(entry.path());
  return files;
}

TEST(Sizes, OfHeaders) {
  for (const fs::path& file : filesOfDirect())
    if (file.extension() == ".h") {
      EXPECT_LE(linesOf(file).size(), kMostHeaderLines) << file;
    }
}

TEST(Sizes, OfFunctions) {
  std::size_t functions = 0;
  for (const fs::path& file : filesOfDirect())
    for (const Long& f : functionsOf(linesOf(file))) {
      EXPECT_LE(f.size, kMostFunctionLines) << file << ": " << f.what;
      ++functions;
    }
  EXPECT_GT(functions, 100u);  // it finds them
}

TEST(Sizes, OfClasses) {
  std::size_t classes = 0;
  for (const fs::path& file : filesOfDirect())
    for (const Long& c : classesOf(linesOf(file))) {
      EXPECT_LE(c.size, kMostMethods) << file << ": " << c.what;
      ++classes;
    }
  EXPECT_GT(classes, 15u);
}

/// How many constants of the step are tuned: those before a file's line "--- Not tuned". Those of
/// `fast` are its own affair (docs/fast.md#constants); of rk's modes none is.
TEST(Sizes, OfTheTunedConstants) {
  int tuned = 0, files = 0;
  for (const char* room :
       {"base", "limits", "contact", "linear", "mechanics", "relaxation", "direct"}) {
    for (const std::string& line :
         linesOf(fs::path(RAGDOLL_SHARE_DIR) / "src/core" / room / "constants.h")) {
      if (line.find("--- Not tuned") != std::string::npos) break;
      if (startsWith(line, "constexpr ")) ++tuned;
      if (startsWith(line, "#pragma once")) ++files;
    }
  }
  EXPECT_EQ(files, 7);
  EXPECT_GT(tuned, 20);
  EXPECT_LE(tuned, 40);
}

}  // namespace
