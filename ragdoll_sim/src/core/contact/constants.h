// What contacts are found by.
// How to read it: direct/constants.h.
#pragma once

#include "core/base/constants.h"

namespace ragdoll {

constexpr double kSpeculative = 0.25;  ///< of the relative travel in a step: so near is near
/// [m] Gaps are told apart to this; a sweep stops there. Half: depth x0.5; double: x2, driven x3.
constexpr double kGapResolution = 1e-4;
constexpr double kNearBody = 0.005;  ///< [m] what comes this near may touch
constexpr double kSameSide = 0.5;    ///< cosine of the most that a normal turns in a motion
/// Of a stick: what moves farther in a motion is another contact.
constexpr double kSamePlace = 0.1;
constexpr double kAlong = 0.9;      ///< cosine: a normal along the stick cannot push it out
constexpr double kParallel = 0.03;  ///< squared sine (10 degrees) below which axes may lie flat

// --- Not tuned: made of others.
/// Of a stick: flat contact spans more of an axis; no axis goes out across itself nearer to an end.
constexpr double kStickEnd = kNoLength;
/// Of a stick: a place that runs farther in a motion cuts it short, so that what then presses there
/// leaves it within kSamePlace.
constexpr double kMostRun = kSamePlace / 2;

// --- Not tuned: rounding.
/// Of a stick: a touch nearer to an end is the particle's, so that it passes from one to the other
/// where both are as deep.
constexpr double kEndOfStick = 1e-9;
/// [m] Axes along each other cross where they are nearer than at their ends by more.
constexpr double kCrossing = 1e-9;

// --- Not tuned: a property of skin and clothes.
constexpr double kBodyFriction = 0.5;  ///< [-] Coulomb coefficient of body on body

}  // namespace ragdoll
