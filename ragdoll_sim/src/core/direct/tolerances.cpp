#include "core/direct/tolerances.h"

#include <algorithm>

#include "core/direct/constants.h"

namespace ragdoll {
namespace {

/// A share of those of coarse steps.
Tolerances shareOfCoarse(double share) {
  const double some = std::clamp(share, kFinestShare, 1.0);
  return {some * kContactTolerance, some * kTouching, some * (kTouching / kLever)};
}

}  // namespace

Tolerances tolerancesFor(double h) { return shareOfCoarse(h * h / (kCoarseStep * kCoarseStep)); }

Tolerances tolerancesWithin(double error) {
  return shareOfCoarse(kFinestShare * error / kTouching);
}

}  // namespace ragdoll
