#include "core/direct/tolerances.h"

#include <algorithm>

#include "core/direct/constants.h"

namespace ragdoll {
namespace {

constexpr double kFinestShare = 1e-3;  ///< as small as tolerances get: rounding is near

}  // namespace

Tolerances tolerancesFor(double h) {
  const double share = std::clamp(h * h / (kCoarseStep * kCoarseStep), kFinestShare, 1.0);
  return {share * kContactTolerance, share * kTouching, share * (kTouching / kLever)};
}

}  // namespace ragdoll
