// Memory of steps within a tolerance (adaptive_step.h).
#pragma once

#include <cstddef>
#include <vector>

#include "core/direct/saved_motion.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

struct AdaptiveScratch {
  Inputs inputs;                    ///< of the present part
  std::vector<Pose> obstacles;      ///< at the step's start
  std::vector<Vec3> pins;           ///< likewise
  std::vector<SavedMotion> start;   ///< what a part begins with: of the island's bodies, by ragdoll
  std::size_t logged = 0;           ///< likewise
  std::vector<SavedMotion> coarse;  ///< likewise: what a part in one came to
  /// What pressed at the end of the last part that stood, and in the middle and at the end of the
  /// one at hand.
  Roomy<CachedImpulse> before, middle, after;
};

}  // namespace ragdoll
