// What some ragdolls' steps start from, to take them back to it; the state's other columns stay.
#pragma once

#include "core/direct/body.h"

namespace ragdoll {

struct SavedMotion {
  Points x, v;                      ///< columns as the state's
  std::vector<double> multipliers;  ///< as the state's
};

/// Room for all ragdolls.
void makeRoom(const State& state, SavedMotion& saved);

/// Of one ragdoll.
void save(const StepContext& step, int ragdoll, SavedMotion& saved);
void restore(const StepContext& step, int ragdoll, const SavedMotion& saved);

}  // namespace ragdoll
