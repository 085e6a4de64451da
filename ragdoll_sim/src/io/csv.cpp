#include "ragdoll_sim/io/csv.h"

#include <cstdio>
#include <ostream>
#include <string>

namespace ragdoll {
/// printf is fast, but writes the decimal point of the locale.
void appendCsv(double value, std::string& row) {
  char text[40];
  const int length = std::snprintf(text, sizeof text, ",%.17g", value);
  for (int i = 1; i < length; ++i) {
    if (text[i] == ',') text[i] = '.';
  }
  row.append(text, static_cast<std::size_t>(length));
}

void writeCsvHeader(const Model& model, std::ostream& out) {
  out << "step,time";
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i) {
    const std::string prefix = i == 0 ? "" : model.ragdolls[i].name + "/";
    const Skeleton& skeleton = model.skeletonOf(model.ragdolls[i]);
    for (int p = 0; p < skeleton.named; ++p) {
      for (const char axis : {'x', 'y', 'z'})
        out << ',' << prefix << skeleton.particles[p] << '.' << axis;
    }
  }
  out << '\n';
}

void writeCsvRow(const Model& model, const State& state, double time, std::ostream& out) {
  std::string row = std::to_string(state.step);
  appendCsv(time, row);
  for (const Ragdoll& r : model.ragdolls) {
    for (int i = r.first; i < r.first + model.skeletonOf(r).named; ++i) {
      for (int axis = 0; axis < 3; ++axis) appendCsv(state.x(axis, i), row);
    }
  }
  out << row << '\n';
}

}  // namespace ragdoll
