#pragma once

namespace ragdoll {

/// [m] leg to knee of the human of 1.75 m whom the measures of coat and skin belong to.
constexpr double kThigh = 0.4244;

}  // namespace ragdoll
