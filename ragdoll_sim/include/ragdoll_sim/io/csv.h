// Trajectories as CSV: `step,time,<particle>.x,<particle>.y,<particle>.z,...`, 17 significant
// digits, so that a row holds the exact state. Ragdolls after the first prefix their particles with
// `<ragdoll>/`.
#pragma once

#include <iosfwd>
#include <string>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// ",<value>" with 17 significant digits, whatever the locale.
void appendCsv(double value, std::string& row);

void writeCsvHeader(const Model& model, std::ostream& out);

/// `time` [s] is step times step length: state.time sums steps up and carries their rounding.
void writeCsvRow(const Model& model, const State& state, double time, std::ostream& out);

}  // namespace ragdoll
