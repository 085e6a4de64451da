// How `method: rk` is run from event to event against closed forms, and how near it comes to them.
#pragma once

namespace ragdoll::test {

constexpr double kStep = 1.0 / 120;  ///< [s]
constexpr double kNear = 1e-9;       ///< [m]

}  // namespace ragdoll::test
