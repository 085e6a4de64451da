// What the thesis's method and its guard are tuned by.
// Not here, since not tuned: sizes, guards against rounding, and caps of loops that converge.
#pragma once

namespace ragdoll {

constexpr double kMostStretch = 0.25;  ///< of a length; falls and swings of a human stay below
constexpr double kMostDepth = 0.5;     ///< of the radius: deeper than sweeps leave behind
constexpr double kMostGain = 0.25;     ///< of the energy: sweeps that work gain less than a third
constexpr double kFreeSpeed = 1.0;     ///< [m/s] of the whole body: gains of less are let be

}  // namespace ragdoll
