// Overlap of bodies with themselves and with each other, as capsules.
#pragma once

#include <algorithm>

#include "core/contact/capsule_pairs.h"
#include "support/worlds.h"

namespace ragdoll::test {

inline CapsuleAxis axisOf(const World& world, const Ragdoll& r, int k) {
  const Skeleton& s = world.model.skeletonOf(r);
  const Capsule& c = s.capsules[k];
  return {world.x(r.first + c.a), world.x(r.first + c.b), s.radius[c.a], s.radius[c.b]};
}

/// [m] the deepest overlap of two ragdolls.
inline double deepestBetween(const World& world, int p, int q) {
  const Ragdoll &r = world.model.ragdolls[p], &s = world.model.ragdolls[q];
  double deepest = 0;
  for (int k = 0; k < static_cast<int>(world.model.skeletonOf(r).capsules.size()); ++k)
    for (int l = 0; l < static_cast<int>(world.model.skeletonOf(s).capsules.size()); ++l) {
      const CapsuleAxis a = axisOf(world, r, k), b = axisOf(world, s, l);
      deepest = std::max(deepest, -gapAt(a, b, nearestPoints(a, b)));
    }
  return deepest;
}

/// [m] the deepest of any two.
inline double deepestBetween(const World& world) {
  double deepest = 0;
  const int count = static_cast<int>(world.model.ragdolls.size());
  for (int p = 0; p < count; ++p)
    for (int q = p + 1; q < count; ++q) deepest = std::max(deepest, deepestBetween(world, p, q));
  return deepest;
}

/// [m] the deepest overlap of a ragdoll with itself, over the pairs that may touch.
inline double deepestSelfPair(const World& world) {
  double deepest = 0;
  for (const Ragdoll& r : world.model.ragdolls)
    for (const CapsulePair& p : world.model.skeletonOf(r).self_pairs) {
      const CapsuleAxis a = axisOf(world, r, p.first), b = axisOf(world, r, p.second);
      deepest = std::max(deepest, -gapAt(a, b, nearestPoints(a, b)));
    }
  return deepest;
}

}  // namespace ragdoll::test
