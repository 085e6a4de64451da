#include "core/direct/tolerances.h"

#include <algorithm>

#include "core/direct/constants.h"

namespace ragdoll {

Tolerances tolerancesFor(double h) {
  const double share = std::clamp(h * h / (kCoarseStep * kCoarseStep), kFinestShare, 1.0);
  return {share * kContactTolerance, share * kTouching, share * (kTouching / kLever)};
}

}  // namespace ragdoll
