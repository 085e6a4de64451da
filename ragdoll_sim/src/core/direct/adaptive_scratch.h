// Memory of steps within a tolerance (adaptive_step.h).
#pragma once

#include <cstddef>
#include <vector>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

struct AdaptiveScratch {
  Inputs inputs;                ///< of the present part
  std::vector<Pose> obstacles;  ///< at the step's start
  std::vector<Vec3> pins;       ///< likewise
  /// What a part begins with: of the island's bodies, one after the other.
  Points x, v;
  std::vector<double> multipliers;
  std::size_t logged = 0;
  Points coarse_x, coarse_v;  ///< what a part in one came to
  /// What pressed at the end of the last part that stood, and of the one at hand: taken once, and
  /// its halves.
  std::vector<CachedImpulse> before, once, middle, after;
};

}  // namespace ragdoll
