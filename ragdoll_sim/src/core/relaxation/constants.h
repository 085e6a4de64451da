// What the thesis's method and its guard are tuned by.
// How to read it: direct/constants.h.
#pragma once

namespace ragdoll {

/// Of a stick's length and of the energy that there was: what sweeps that work stay below.
constexpr double kFailed = 0.25;
constexpr double kFreeSpeed = 1.0;  ///< [m/s] of the whole body: gains of less are let be

// --- Not tuned: made of others.
constexpr double kMostDepth = 2 * kFailed;  ///< of the radius: deeper than sweeps leave behind

// --- Not tuned: rounding.
constexpr double kReportedGain = 1e-6;  ///< [J] less is not told

}  // namespace ragdoll
