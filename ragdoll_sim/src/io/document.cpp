#include "document.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "ragdoll_sim/core/error.h"

namespace ragdoll::io {
namespace {

std::string place(const std::string& name, int line) { return name + ":" + std::to_string(line); }

/// Builds the tree from the parser's events and refuses what is too much.
class TreeBuilder final : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::string& name) : name_(name) {}

  const std::shared_ptr<Value>& root() const { return root_; }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add(Value::Kind::kNothing, mark, anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    const auto scalar = add(Value::Kind::kText, mark, anchor);
    scalar->text = value;
    const bool plain = tag == "?";
    if (plain && (value == "~" || value == "null")) scalar->kind = Value::Kind::kNothing;
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    for (const auto& parent : open_) {
      if (parent.second == anchor)
        throw Error(place(name_, mark.line + 1), "an alias inside itself");
    }
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) throw Error(place(name_, mark.line + 1), "an unknown alias");
    append(found->second, mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(Value::Kind::kList, mark, anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(Value::Kind::kMap, mark, anchor);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  void append(const std::shared_ptr<Value>& value, const YAML::Mark& mark) {
    if (++count_ > kMaxValues) {
      throw Error(place(name_, mark.line + 1),
                  "more than " + std::to_string(kMaxValues) + " values; a scene file is smaller");
    }
    if (open_.empty()) {
      root_ = value;
    } else {
      open_.back().first->items.push_back(value);
    }
  }

  std::shared_ptr<Value> add(Value::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    const auto value = std::make_shared<Value>();
    value->kind = kind;
    value->line = mark.line + 1;
    append(value, mark);
    if (anchor != 0) anchors_[anchor] = value;
    return value;
  }

  void open(Value::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (open_.size() >= static_cast<std::size_t>(kMaxDepth)) {
      throw Error(place(name_, mark.line + 1),
                  "nested deeper than " + std::to_string(kMaxDepth) + " levels");
    }
    const auto value = add(kind, mark, anchor);
    open_.emplace_back(value, anchor);
  }

  std::string name_;
  int count_ = 0;
  std::shared_ptr<Value> root_;
  std::vector<std::pair<std::shared_ptr<Value>, YAML::anchor_t>> open_;
  std::map<YAML::anchor_t, std::shared_ptr<Value>> anchors_;
};

void checkText(const std::string& text, const std::string& name) {
  if (text.size() > kMaxBytes) {
    throw Error(name,
                "larger than " + std::to_string(kMaxBytes >> 20) + " MiB; no scene needs that");
  }
  int line = 1;
  char last = 0;
  for (const char c : text) {
    if (c == '\n') ++line;
    // Before 0.7 yaml-cpp finds a token without a character here, again and again until memory
    // ends. Where quotes and comments end it alone knows, so ":]" is refused there, too.
    if (last == ':' && c == ']')
      throw Error(place(name, line), "':' before ']'; a space is expected between them");
    last = c;
    const auto byte = static_cast<unsigned char>(c);
    const bool space = c == '\n' || c == '\r' || c == '\t';
    if ((byte < 0x20 && !space) || byte == 0x7f) {
      throw Error(place(name, line), "not a text file (control character); YAML is expected");
    }
  }
}

/// Nothing but comments.
bool isEmpty(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find_first_not_of(" \t\r");
    if (at != std::string::npos && line[at] != '#') return false;
  }
  return true;
}

/// The parser calls a tab in the indentation many things.
bool isIndentedByTab(const std::string& text, int line) {
  std::istringstream lines(text);
  std::string last;
  for (int i = 0; i <= line; ++i)
    if (!std::getline(lines, last)) return false;
  return last.find_last_of('\t', last.find_first_not_of(" \t")) != std::string::npos;
}

}  // namespace

std::shared_ptr<const Value> parseDocument(const std::string& text, const std::string& name) {
  checkText(text, name);
  if (isEmpty(text)) throw Error(place(name, 1), "the text is empty; a mapping is expected");
  TreeBuilder tree(name);
  try {
    // The mark of a document's end: before 0.7 yaml-cpp takes what follows a ':' at the end of the
    // text for a token, without end, and reads past its last token after an anchor or a tag there.
    std::istringstream stream(text + "\n...\n");
    YAML::Parser parser(stream);
    parser.HandleNextDocument(tree);
    TreeBuilder rest(name);
    if (tree.root() && parser.HandleNextDocument(rest) && rest.root()) {
      throw Error(place(name, rest.root()->line), "a second YAML document; one is expected");
    }
  } catch (const YAML::Exception& error) {
    const bool located = !error.mark.is_null();
    const bool tab = located && isIndentedByTab(text, error.mark.line);
    throw Error(located ? place(name, error.mark.line + 1) : name,
                "not valid YAML: " + (tab ? "indented by a tab; spaces are expected" : error.msg));
  }
  if (!tree.root()) throw Error(place(name, 1), "not valid YAML: no value");
  return tree.root();
}

std::string readFile(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!fs::exists(status)) throw Error(path, "no such file");
  if (!fs::is_regular_file(status)) throw Error(path, "not a regular file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path, "cannot be read");
  std::string text;
  char buffer[65536];
  while (text.size() <= kMaxBytes && (file.read(buffer, sizeof buffer) || file.gcount() > 0)) {
    text.append(buffer, static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad()) throw Error(path, "cannot be read");
  return text;
}

std::string quoted(const std::string& text) {
  constexpr std::size_t kLongest = 40;
  std::string shown = text.substr(0, kLongest);
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return "'" + shown + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace ragdoll::io
