// Which capsules of one skeleton may touch each other: decided once, from the rest pose.
//
// Every stick between two named particles is a capsule, those of a rigid group too: the torso's
// sticks and diagonals leave no hole that an arm fits through. A particle without a stick is a
// sphere. Left out are pairs that share a particle (a joint), pairs inside one rigid group, and
// pairs that overlap in the rest pose.
#pragma once

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Fills capsules; the pairs too if `self`.
void addCapsules(Skeleton& skeleton, bool self);

/// "left_elbow-left_hand", or a lone particle's name.
std::string capsuleName(const Skeleton& skeleton, int capsule);

/// What was decided, for the log: how many pairs there are and how many are left out, in a first
/// line; then by name those left out, a line for each reason.
std::string describePairs(const Skeleton& skeleton);

/// The first line of a note (Model::notes).
std::string inShort(const std::string& note);

}  // namespace ragdoll
