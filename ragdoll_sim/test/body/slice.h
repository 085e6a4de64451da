#pragma once

#include <cmath>
#include <vector>

#include "ragdoll_sim/body/mesh.h"

namespace ragdoll::test {

/// Vertices at most `thickness` [m] from the plane through p across the direction, within `reach`
/// [m] of p, in the order in which they were made: of a skin, around the ring.
inline std::vector<int> slice(const Mesh& mesh, const Vec3& p, const Vec3& across, double reach,
                              double thickness) {
  std::vector<int> found;
  for (int i = 0; i < mesh.vertices.cols(); ++i) {
    const Vec3 d = mesh.vertices.col(i) - p;
    if (std::abs(d.dot(across.normalized())) < thickness && d.norm() < reach) found.push_back(i);
  }
  return found;
}

}  // namespace ragdoll::test
