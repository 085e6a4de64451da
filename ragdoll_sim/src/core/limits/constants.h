// What limits are looked at by.
// How to read it: direct/constants.h.
#pragma once

#include "core/base/constants.h"

namespace ragdoll {

constexpr double kNearLimit = 0.3;  ///< [rad] limits this near take part: a step may reach them

// --- Not tuned: made of others.
constexpr double kNoAngle = kNoLength;  ///< [-] a projection shorter than this (1 deg) has no angle

}  // namespace ragdoll
