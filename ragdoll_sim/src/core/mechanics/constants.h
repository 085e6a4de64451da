// What sleep and findings go by; the speeds and times of sleep are public (sleep.h).
// Not tuned: sizes, guards against rounding, caps of loops that converge, and what is made of
// another constant.
#pragma once

namespace ragdoll {

constexpr double kWakeReach = 0.05;  ///< [m] an obstacle that moves this near wakes a body

}  // namespace ragdoll
