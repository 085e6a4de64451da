// What limits are looked at by.
// Not tuned: sizes, guards against rounding, caps of loops that converge, and what is made of
// another constant. Unless it says more, half and double of a constant break no law of 60 random
// scenes and 12 piles (ragdoll_lab extremes --random-only) and cost the same within 10 %.
#pragma once

namespace ragdoll {

constexpr double kNearLimit = 0.3;  ///< [rad] limits this near take part: a step may reach them
constexpr double kNoAngle = 0.02;   ///< [-] a projection shorter than this (1 deg) has no angle

}  // namespace ragdoll
