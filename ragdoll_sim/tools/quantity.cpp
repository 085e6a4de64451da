#include "quantity.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "ragdoll_sim/core/error.h"

namespace ragdoll::lab {
namespace {

struct Unit {
  const char* name;
  double size;  ///< in SI
};

const std::vector<Unit> kLengths = {
    {"nm", 1e-9}, {"um", 1e-6}, {"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}};
const std::vector<Unit> kTimes = {{"ns", 1e-9}, {"us", 1e-6}, {"ms", 1e-3}, {"s", 1}};

double parseWithUnit(const std::string& option, const std::string& text,
                     const std::vector<Unit>& units, const char* example) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  std::string unit = end;
  unit.erase(0, unit.find_first_not_of(' '));
  if (end != text.c_str() && std::isfinite(number))
    for (const Unit& known : units)
      if (unit == known.name && number * known.size > 0) return number * known.size;
  std::string names;
  for (const Unit& known : units) names += (names.empty() ? "" : ", ") + std::string(known.name);
  throw Error(option, "'" + text + "' is not a positive number with a unit (" + names +
                          "), such as " + example);
}

std::string inUnit(double value, const std::vector<Unit>& units) {
  const Unit* best = &units.front();
  for (const Unit& unit : units)
    if (unit.name != std::string("cm") && std::abs(value) >= unit.size) best = &unit;
  char text[40];
  std::snprintf(text, sizeof text, "%.3g %s", value / best->size, best->name);
  return text;
}

}  // namespace

double parseLength(const std::string& option, const std::string& text) {
  return parseWithUnit(option, text, kLengths, "1mm");
}

double parseTime(const std::string& option, const std::string& text) {
  const std::string per_second = "/s";
  const bool named = text.size() > 2 && text.substr(text.size() - 2) == per_second;
  return parseWithUnit(option, named ? text.substr(0, text.size() - 2) : text, kTimes, "50us");
}

std::string lengthText(double metres) { return inUnit(metres, kLengths); }
std::string timeText(double seconds) { return inUnit(seconds, kTimes); }

}  // namespace ragdoll::lab
