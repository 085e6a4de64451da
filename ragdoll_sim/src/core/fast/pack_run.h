// One pack of bodies through a step. Private to the fast method.
#pragma once

#include "core/fast/fast.h"

namespace ragdoll::fast {

/// Moves the bodies of a batch by the step, but for those that it leaves to the direct method.
void stepPack(const StepContext& context, const FastScratch& scratch, PackScratch& pack,
              Batch& batch);

}  // namespace ragdoll::fast
