// One model file, checked and resolved: SkeletonSpec -> Skeleton.
#pragma once

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Throws Error that names the place in the file, the key and what would be right.
Skeleton buildSkeleton(const SkeletonSpec& spec);

/// Checks the joints and resolves them into limits; segments, sticks and joints are there. Throws
/// Error.
void addLimits(const SkeletonSpec& spec, Skeleton& skeleton);

/// The constant scalar mass matrix [kg], n x n: lumped masses on the diagonal, a bone as a rigid
/// rod, a group by barycentric weights (docs/equations.md#inertia). Throws if a particle ends up
/// massless.
Eigen::MatrixXd massMatrix(const SkeletonSpec& spec, const Skeleton& skeleton);

}  // namespace ragdoll
