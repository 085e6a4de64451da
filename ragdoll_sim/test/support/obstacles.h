// Obstacles by their sizes alone, as what knows distances wants them.
#pragma once

#include "ragdoll_sim/core/model.h"

namespace ragdoll::test {

/// half: of a box, its half edges; of a capsule (0, 0, half length). [m]
inline Obstacle obstacle(ObstacleSpec::Type type, const Vec3& half, double radius = 0) {
  Obstacle o;
  o.type = type;
  o.half = half;
  o.radius = radius;
  return o;
}

}  // namespace ragdoll::test
