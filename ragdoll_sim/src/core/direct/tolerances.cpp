#include "core/direct/tolerances.h"

#include <algorithm>

#include "core/direct/constants.h"

namespace ragdoll {
namespace {

/// Of tolerances in short steps: rounding is near. Of a part's error: what touches.
constexpr double kFinestShare = 1e-4;
/// In short steps, of what a solution leaves: less than of what counts as touching, as what is left
/// decides what is hit next. As above: a window of fall is 4e-8 m off at any step above 30 kHz, not
/// 8e-9. Parts within a tolerance gain nothing by it.
constexpr double kFinestSolution = 1e-5;

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
