// Rigid groups of a skeleton, and the frames that hold them for the direct methods.
//
// A group of k points joined by all k (k - 1) / 2 sticks is rigid, but its sticks are dependent (k
// > 4), or have no first-order stiffness out of their plane (a mirror-symmetric pelvis is always
// flat). A frame of rank + 1 points has neither fault: the group's points are fixed affine
// combinations of it, and sticks remain between the frame's points only. Points shared with an
// earlier group serve as frame points; the others are invented, at the group's centre and along its
// principal axes as far out as it reaches, which makes the system well conditioned whatever the
// geometry (docs/equations.md#rigid-groups).
#pragma once

#include <utility>
#include <vector>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Named groups with mass, complete subgraphs of sticks, and what shares three points or more with
/// another, merged. Largest first.
std::vector<RigidGroup> findRigidGroups(const SkeletonSpec& spec, const Skeleton& skeleton);

/// Rank of a set of points: singular values below kFlat of the largest count as none.
int affineRank(const Points& points);

/// x = T q: all particles from base points; q = L x back. Rows of `sticks` are differences of base
/// combinations, with their lengths.
struct BaseMap {
  Eigen::MatrixXd T;       ///< n x m
  Eigen::MatrixXd L;       ///< m x n, L T = 1
  Eigen::MatrixXd sticks;  ///< s x m
  Eigen::VectorXd length;  ///< [m] s
  std::vector<std::pair<int, int>>
      ends;  ///< particles of a stick of the file; (-1, g): of the frame of group g
};

/// Moves the rest positions of groups that count as flat (or straight) exactly into their plane
/// (line).
void flattenGroups(Skeleton& skeleton);

/// The map for a skeleton with its groups. Without groups T and L are 1 and the sticks are the
/// file's.
BaseMap baseMap(const Skeleton& skeleton);

}  // namespace ragdoll
