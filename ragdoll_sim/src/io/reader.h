// Typed, strict access to a parsed text. Every failure is an Error that names file, line and key
// path
// ("fall.yaml:12: ragdolls[0].position") and says what would be right.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "document.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll::io {

constexpr double kDegree = M_PI / 180;  ///< [rad]

class Reader {
 public:
  /// The root of a text called `file`.
  Reader(std::shared_ptr<const Value> root, std::string file);

  /// An entry of a mapping, or an item of a list. Line 0: of a text that has no lines to name.
  Reader(std::shared_ptr<const Value> value, std::string file, std::string path, int line);

  std::string where() const;
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void failType(const std::string& expected) const;

  const std::string& file() const { return file_; }
  const std::string& path() const { return path_; }
  const std::shared_ptr<const Value>& value() const { return value_; }
  bool isText() const { return value_->kind == Value::Kind::kText; }
  bool isList() const { return value_->kind == Value::Kind::kList; }
  bool isMap() const { return value_->kind == Value::Kind::kMap; }

  double number() const;                         ///< finite
  double positive() const;                       ///< > 0
  double notNegative() const;                    ///< >= 0
  double within(double low, double high) const;  ///< low <= number <= high
  int integer(int low, int high) const;
  bool boolean() const;
  std::string text() const;  ///< not empty
  std::string name() const;  ///< text of letters, digits, '_', '-' and '.'
  Vec3 vector() const;       ///< [x, y, z]
  Vec3 direction() const;    ///< [x, y, z] of any length but 0, made a unit vector
  std::vector<double> numbers(std::size_t count) const;
  std::vector<Reader> list(std::size_t most) const;

  /// Index of the text in `choices`.
  std::size_t choice(const std::vector<std::string>& choices) const;

 private:
  std::shared_ptr<const Value> value_;
  std::string file_, path_;
  int line_;
};

/// A mapping. With keys that a format fixes: find() or need() them all, then finish(). With keys
/// that the user chooses: entries().
class MapReader {
 public:
  /// Checks that keys are plain names and that none is there twice; at most `most` of them.
  explicit MapReader(const Reader& reader, std::size_t most = 100);

  std::optional<Reader> find(const std::string& key);
  Reader need(const std::string& key);
  const std::vector<std::pair<std::string, Reader>>& entries() const { return entries_; }

  /// Fails on `key` that is not there and lists those that are: one of them may be a slip of it.
  [[noreturn]] void missing(const std::string& key) const;

  /// Fails on the first key that was never asked for and lists those that were.
  void finish() const;

 private:
  Reader reader_;
  std::vector<std::pair<std::string, Reader>> entries_;
  std::vector<bool> used_;
  std::vector<std::string> asked_;
};

/// "a, b, c"
std::string joined(const std::vector<std::string>& names);

}  // namespace ragdoll::io
