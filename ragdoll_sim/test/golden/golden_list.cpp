#include "golden_list.h"

#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace ragdoll::golden {
namespace {

constexpr const char* kHead =
    "# The bits of the simulation. Written by golden_test --write, not by hand; what it is:\n"
    "# golden_test.cpp. state: hash of the last positions and velocities; memory: of all of State\n"
    "# after every step; then steps and the sums of the StepReport's fields.\n";
constexpr int kShown = 10;  ///< cases that a message shows

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016" PRIx64, value);
  return text;
}

std::string difference(const Outcome& expected, const Outcome& got) {
  std::string text;
  const auto compare = [&](const std::string& what, const std::string& a, const std::string& b) {
    if (a != b) text += (text.empty() ? "" : "; ") + what + " expected " + a + ", got " + b;
  };
  compare("state", hex(expected.state), hex(got.state));
  compare("memory", hex(expected.memory), hex(got.memory));
  compare("steps", std::to_string(expected.steps), std::to_string(got.steps));
  for (int i = 0; i < kSumCount; ++i)
    compare(kSums[i], std::to_string(expected.sums[i]), std::to_string(got.sums[i]));
  return text;
}

/// Counts what differs and tells the first few.
class Differences {
 public:
  void add(const std::string& name, const std::string& what) {
    if (count_++ < kShown) text_ += "  " + name + "\n      " + what + "\n";
    ++groups_[name.substr(0, name.find(':'))];
  }

  std::string text(std::size_t of) const {
    if (count_ == 0) return "";
    std::ostringstream out;
    out << count_ << " of " << of << " cases differ (";
    const char* separator = "";
    for (const auto& [group, count] : groups_) {
      out << separator << count << " " << group;
      separator = ", ";
    }
    out << "):\n" << text_;
    if (count_ > kShown) out << "  ... and " << count_ - kShown << " more\n";
    return out.str();
  }

 private:
  int count_ = 0;
  std::string text_;
  std::map<std::string, int> groups_;
};

}  // namespace

List readList(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + " cannot be read");
  List list;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    const std::size_t equals = line.find(" = ");
    if (equals != std::string::npos) {
      list.build.emplace_back(line.substr(0, equals), line.substr(equals + 3));
      continue;
    }
    std::istringstream words(line);
    Outcome o;
    words >> std::hex >> o.state >> o.memory >> std::dec >> o.steps;
    for (std::uint64_t& sum : o.sums) words >> sum;
    std::string name;
    if (!std::getline(words >> std::ws, name))
      throw std::runtime_error(path + ":" + std::to_string(number) + " is not a case: " + line);
    list.cases[name] = o;
  }
  return list;
}

void writeList(const List& list, const std::string& path) {
  std::ofstream file(path);
  file << kHead;
  for (const auto& [what, value] : list.build) file << what << " = " << value << "\n";
  file << "#          state           memory steps";
  for (const char* name : kSums) file << " " << name;
  file << " case\n";
  for (const auto& [name, o] : list.cases) {
    file << hex(o.state) << " " << hex(o.memory) << " " << o.steps;
    for (const std::uint64_t sum : o.sums) file << " " << sum;
    file << " " << name << "\n";
  }
  file.close();
  if (!file) throw std::runtime_error(path + " cannot be written");
}

std::string differences(const Build& recorded, const Build& here) {
  std::string text;
  const std::map<std::string, std::string> now(here.begin(), here.end());
  for (const auto& [what, value] : recorded) {
    const auto found = now.find(what);
    const std::string other = found == now.end() ? "nothing" : found->second;
    if (other != value) text += "  " + what + ": " + value + "; here " + other + "\n";
  }
  if (recorded.size() != here.size()) text += "  the list names other things than this program\n";
  return text;
}

std::string differences(const List& expected, const List& got) {
  Differences found;
  for (const auto& [name, outcome] : got.cases) {
    const auto other = expected.cases.find(name);
    if (other == expected.cases.end())
      found.add(name, "is new");
    else if (!(other->second == outcome))
      found.add(name, difference(other->second, outcome));
  }
  for (const auto& [name, outcome] : expected.cases)
    if (got.cases.count(name) == 0) found.add(name, "is gone");
  return found.text(expected.cases.size());
}

}  // namespace ragdoll::golden
