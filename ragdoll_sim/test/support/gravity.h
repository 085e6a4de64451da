// Gravity as scenes have it by default.
#pragma once

namespace ragdoll::test {

constexpr double kG = 9.81;  ///< [m/s^2]

}  // namespace ragdoll::test
