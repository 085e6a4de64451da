// A start that keeps the joint limits.
//
// A rest pose may be a little outside the limits of its own model, and `place` puts single
// particles anywhere. A joint that starts outside its hard limits would be thrown back in the first
// step; so the body is put right at load instead, by the least motion in the mass metric that
// brings the joints back and keeps the sticks as long as they are. What is placed or pinned stays
// where it is, if it can.
#pragma once

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// [m] Where the particles of a body of this model start, in the model's axes: the rest pose, or,
/// if that is outside hard limits, a pose near it that is not, with a warning that names the
/// joints, by how much, and what moved. What the limits measure from stays the rest pose. Throws
/// Error if no such pose is found.
Points startPose(const SkeletonSpec& spec, Skeleton& skeleton);

/// Corrects model.start_position of one ragdoll, some of whose particles were placed; pins and
/// systems are there. Warnings as above. Sticks far from their lengths are drawn in by the first
/// steps, which no pose now can answer for: then it only warns. Throws Error if the pins leave no
/// way.
void correctStart(const RagdollSpec& spec, Model& model, int ragdoll);

}  // namespace ragdoll
