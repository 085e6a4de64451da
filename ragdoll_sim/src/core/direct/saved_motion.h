// What a ragdoll's step, or a part of it, starts from, to take it back to that.
#pragma once

#include <vector>

#include "core/direct/step_context.h"

namespace ragdoll {

/// Of one ragdoll.
struct SavedMotion {
  Points x, v;                      ///< 3 x n
  std::vector<double> multipliers;  ///< all that the state has of them
};

void makeRoom(const StickRows& rows, SavedMotion& saved);
/// Of each of the model's ragdolls.
void makeRoom(const Model& model, std::vector<SavedMotion>& saved);

void save(const StepContext& step, int ragdoll, SavedMotion& saved);
void restore(const StepContext& step, int ragdoll, const SavedMotion& saved);

}  // namespace ragdoll
