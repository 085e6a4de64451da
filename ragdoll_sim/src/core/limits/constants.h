// What limits are looked at by.
// Not here, since not tuned: sizes, guards against rounding, and caps of loops that converge.
#pragma once

namespace ragdoll {

constexpr double kNearLimit = 0.3;  ///< [rad] limits this near take part: a step may reach them
constexpr double kNoAngle = 0.02;   ///< [-] a projection shorter than this (1 deg) has no angle

}  // namespace ragdoll
