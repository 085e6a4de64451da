// Bodies of a step in packs: who shares one, and what they have left, in parts of the step. Private
// to the fast method.
#pragma once

#include <vector>

#include "core/fast/fast.h"

namespace ragdoll::fast {

/// What packs of this step want of the scene.
void prepare(const StepContext& context, FastScratch& scratch);

/// Moves bodies, each by itself, by the step; what came of it is in the batches. What it leaves
/// stays where it is, and goes to `left`.
void stepBatches(const StepContext& context, const std::vector<int>& bodies, FastScratch& scratch,
                 std::vector<int>& left);

/// Calls to(batch) for all of that.
template <class To>
void forBatches(const FastScratch& scratch, const To& to) {
  for (int i = 0; i < scratch.batch_count; ++i) to(scratch.batches[i]);
  for (int i = 0; i < scratch.again_count; ++i) to(scratch.again_batches[i]);
}

}  // namespace ragdoll::fast
