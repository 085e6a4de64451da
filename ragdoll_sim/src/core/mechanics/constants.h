// What sleep and findings go by; the speeds and times of sleep are public (sleep.h).
// How to read it: direct/constants.h.
#pragma once

#include "core/contact/constants.h"

namespace ragdoll {

// --- Not tuned: made of others.
constexpr double kWakeReach = 10 * kNearBody;  ///< [m] an obstacle that moves this near wakes a body

}  // namespace ragdoll
