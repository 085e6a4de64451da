#include "reader.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <set>
#include <sstream>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/number_text.h"

namespace ragdoll::io {
namespace {

constexpr double kUnitTolerance =
    1e-14;  ///< a vector this close to unit length stays as it is, bit for bit

std::string lower(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

bool isNonFinite(const std::string& text) {
  std::string bare = lower(text);
  if (!bare.empty() && (bare[0] == '+' || bare[0] == '-')) bare.erase(0, 1);
  if (!bare.empty() && bare[0] == '.') bare.erase(0, 1);
  return bare == "nan" || bare == "inf" || bare == "infinity";
}

bool isName(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  });
}

}  // namespace

Reader::Reader(std::shared_ptr<const Value> root, std::string file)
    : Reader(root, std::move(file), "", root->line) {}

Reader::Reader(std::shared_ptr<const Value> value, std::string file, std::string path, int line)
    : value_(std::move(value)), file_(std::move(file)), path_(std::move(path)), line_(line) {}

std::string Reader::where() const {
  std::string place = file_;
  if (line_ > 0) place += ":" + std::to_string(line_) + (path_.empty() ? "" : ":");
  if (!path_.empty()) place += " " + path_;
  return place;
}

void Reader::fail(const std::string& what) const { throw Error(where(), what); }

void Reader::failType(const std::string& expected) const {
  switch (value_->kind) {
    case Value::Kind::kNothing:
      fail("has no value; " + expected + " is expected");
    case Value::Kind::kText:
      fail("is " + quoted(value_->text) + "; " + expected + " is expected");
    case Value::Kind::kList:
      fail("is a list; " + expected + " is expected");
    case Value::Kind::kMap:
      fail("is a mapping; " + expected + " is expected");
  }
  fail(expected + " is expected");
}

double Reader::number() const {
  if (!isText()) failType("a number");
  if (isNonFinite(value_->text)) failType("a finite number");
  std::istringstream stream(value_->text);
  stream.imbue(std::locale::classic());
  double number = 0;
  stream >> std::noskipws >> number;
  const bool overflow = stream.fail() && std::abs(number) > 1;
  if (overflow) failType("a finite number");
  if (stream.fail() || stream.peek() != std::istringstream::traits_type::eof())
    failType("a number");
  return number;
}

double Reader::positive() const {
  const double result = number();
  if (!(result > 0)) fail("is " + numberText(result) + "; a number above 0 is expected");
  return result;
}

double Reader::notNegative() const {
  const double result = number();
  if (!(result >= 0)) fail("is " + numberText(result) + "; 0 or a positive number is expected");
  return result;
}

double Reader::within(double low, double high) const {
  const double result = number();
  if (!(result >= low && result <= high)) {
    fail("is " + numberText(result) + "; a number from " + numberText(low) + " to " +
         numberText(high) + " is expected");
  }
  return result;
}

int Reader::integer(int low, int high) const {
  const std::string expected =
      "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  if (!isText()) failType(expected);
  const double result = number();
  if (result != std::floor(result) || result < low || result > high) failType(expected);
  return static_cast<int>(result);
}

bool Reader::boolean() const {
  if (isText()) {
    const std::string text = lower(value_->text);
    if (text == "true") return true;
    if (text == "false") return false;
  }
  failType("true or false");
}

std::string Reader::text() const {
  if (!isText() || value_->text.empty()) failType("a text");
  return value_->text;
}

std::string Reader::name() const {
  if (!isText() || !isName(value_->text)) failType("a name (letters, digits, '_', '-' and '.')");
  return value_->text;
}

std::vector<double> Reader::numbers(std::size_t count) const {
  const std::string expected = "a list of " + std::to_string(count) + " numbers";
  if (!isList()) failType(expected);
  if (value_->items.size() != count) {
    fail("has " + std::to_string(value_->items.size()) + " items; " + expected + " is expected");
  }
  std::vector<double> result;
  for (const Reader& item : list(count)) result.push_back(item.number());
  return result;
}

Vec3 Reader::vector() const {
  const std::vector<double> n = numbers(3);
  return Vec3(n[0], n[1], n[2]);
}

Vec3 Reader::direction() const {
  const Vec3 given = vector();
  const double length = given.stableNorm();
  if (!(length > kMinLength)) fail("has length 0; a direction is expected, such as [0, 0, 1]");
  if (std::abs(length - 1) < kUnitTolerance) return given;
  return given / length;
}

std::vector<Reader> Reader::list(std::size_t most) const {
  if (!isList()) failType("a list");
  if (value_->items.size() > most) {
    fail("has " + std::to_string(value_->items.size()) + " items; at most " + std::to_string(most) +
         " are possible");
  }
  std::vector<Reader> result;
  result.reserve(value_->items.size());
  for (std::size_t i = 0; i < value_->items.size(); ++i) {
    const auto& item = value_->items[i];
    result.emplace_back(item, file_, path_ + "[" + std::to_string(i) + "]",
                        line_ > 0 ? item->line : 0);
  }
  return result;
}

std::size_t Reader::choice(const std::vector<std::string>& choices) const {
  if (isText()) {
    const auto found = std::find(choices.begin(), choices.end(), value_->text);
    if (found != choices.end()) return static_cast<std::size_t>(found - choices.begin());
  }
  failType("one of " + joined(choices));
}

MapReader::MapReader(const Reader& reader, std::size_t most) : reader_(reader) {
  if (!reader.isMap()) reader.failType("a mapping (key: value)");
  const auto& items = reader.value()->items;
  if (items.size() / 2 > most) {
    reader.fail("has " + std::to_string(items.size() / 2) + " keys; at most " +
                std::to_string(most) + " are possible");
  }
  const std::string prefix = reader.path().empty() ? "" : reader.path() + ".";
  std::set<std::string> seen;
  for (std::size_t i = 0; i + 1 < items.size(); i += 2) {
    const Value& key = *items[i];
    if (key.kind != Value::Kind::kText) {
      Reader(items[i], reader.file(), reader.path(), key.line)
          .fail("a key is expected to be a name");
    }
    const std::string shown = isName(key.text) ? key.text : quoted(key.text);
    entries_.emplace_back(key.text, Reader(items[i + 1], reader.file(), prefix + shown, key.line));
    if (!seen.insert(key.text).second) entries_.back().second.fail("is there twice; once is right");
  }
  used_.assign(entries_.size(), false);
}

std::optional<Reader> MapReader::find(const std::string& key) {
  if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) asked_.push_back(key);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].first != key) continue;
    used_[i] = true;
    return entries_[i].second;
  }
  return std::nullopt;
}

Reader MapReader::need(const std::string& key) {
  const std::optional<Reader> found = find(key);
  if (!found) missing(key);
  return *found;
}

void MapReader::missing(const std::string& key) const {
  std::vector<std::string> present;
  for (const auto& entry : entries_) present.push_back(quoted(entry.first));
  reader_.fail("the key '" + key + "' is missing; there " +
               (present.empty()       ? "is none"
                : present.size() == 1 ? "is " + present[0]
                                      : "are " + joined(present)));
}

void MapReader::finish() const {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (!used_[i]) entries_[i].second.fail("unknown key; the keys here are " + joined(asked_));
  }
}

std::string joined(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

}  // namespace ragdoll::io
