// What sleep and findings go by; the speeds and times of sleep are public (sleep.h).
// Not here, since not tuned: sizes, guards against rounding, and caps of loops that converge.
#pragma once

namespace ragdoll {

constexpr double kWakeReach = 0.05;  ///< [m] an obstacle that moves this near wakes a body

}  // namespace ragdoll
