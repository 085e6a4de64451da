// A YAML text as a plain tree with line numbers, and nothing else: no types are guessed, duplicate
// keys stay visible, and a text that is huge, binary, deeply nested or malformed ends in an Error.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace ragdoll::io {

constexpr std::size_t kMaxBytes = std::size_t{4} << 20;  ///< of one file or text
constexpr int kMaxDepth = 32;        ///< nested lists and mappings; a scene needs 7
constexpr int kMaxValues = 500'000;  ///< of one text

/// One value of the text. Aliases share the value that they name; there are no cycles.
struct Value {
  enum class Kind { kNothing, kText, kList, kMap };
  Kind kind = Kind::kNothing;
  int line = 0;      ///< 1-based
  std::string text;  ///< kText
  std::vector<std::shared_ptr<Value>>
      items;  ///< kList: the items; kMap: key, value, key, value, ...
};

/// Parses exactly one YAML document. `name` is what messages call the text.
std::shared_ptr<const Value> parseDocument(const std::string& text, const std::string& name);

/// The content of a regular file of at most kMaxBytes.
std::string readFile(const std::string& path);

/// The text on one line, shortened, without control characters: safe to quote in a message.
std::string quoted(const std::string& text);

}  // namespace ragdoll::io
