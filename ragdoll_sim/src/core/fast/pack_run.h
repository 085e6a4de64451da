// One pack of bodies through a step. Private to the fast method.
#pragma once

#include "core/fast/fast.h"

namespace ragdoll::fast {

/// Whether bodies that a pack has left are stepped in parts.
bool stepsInParts(const StepContext& context, const FastScratch& scratch);

/// Moves the bodies of a batch by the step, but for those that it leaves.
void stepPack(const StepContext& context, const FastScratch& scratch, PackScratch& pack,
              Batch& batch);

/// The same in parts of the step, of a batch of FastScratch::again.
void stepParts(const StepContext& context, const FastScratch& scratch, PackScratch& pack,
               Batch& batch);

}  // namespace ragdoll::fast
