#include "core/direct/tolerances.h"

#include <algorithm>

#include "core/direct/constants.h"

namespace ragdoll {
namespace {

/// A share of those of coarse steps. finest: the least that a solution gets of it.
Tolerances shareOfCoarse(double share, double finest) {
  const double some = std::clamp(share, kFinestShare, 1.0);
  return {std::clamp(share, finest, 1.0) * kContactTolerance, some * kTouching,
          some * (kTouching / kLever)};
}

}  // namespace

Tolerances tolerancesFor(double h) {
  return shareOfCoarse(h * h / (kCoarseStep * kCoarseStep), kFinestSolution);
}

Tolerances tolerancesWithin(double error) {
  return shareOfCoarse(kFinestShare * error / kTouching, kFinestShare);
}

}  // namespace ragdoll
