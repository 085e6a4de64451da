// A rest pose in which every stick has its length.
//
// Lengths that a model file does not give come from its positions and fit them. Those that it gives
// may not: then the positions follow the lengths, by the smallest move that does it
// (Levenberg-Marquardt on |d| - L). Groups with mass stay where their centre of mass is. Lengths
// that no pose has, a triangle of 1, 1 and 5 m, are refused.
#pragma once

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Moves the rest positions until the sticks have their lengths; a warning says which went how far.
/// Particles and sticks of s are there, in the file's order. Throws Error with the names of the
/// sticks that stay off.
void fitRestPose(const SkeletonSpec& spec, Skeleton& s);

/// [m] Diagonal of the box around the points.
double extent(const Points& x);

/// Positions near x that are no special ones: fixed irrational offsets, a tenth of `size` [m].
/// Another variant, other offsets.
Points genericPose(const Points& x, double size, int variant = 0);

/// "left_hand by 2.5 mm, left_elbow by 1 mm": what has moved; "" if nothing has.
std::string movesText(const Skeleton& s, const Points& before, const Points& after);

/// "'left_elbow-left_hand'"
std::string stickName(const Skeleton& s, int a, int b);

}  // namespace ragdoll
