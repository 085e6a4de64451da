// What contacts are found by.
// Not tuned: sizes, guards against rounding, caps of loops that converge, and what is made of
// another constant. Unless it says more, half and double of a constant break no law of 60 random
// scenes and 12 piles (ragdoll_lab extremes --random-only) and cost the same within 10 %.
#pragma once

namespace ragdoll {

constexpr double kSpeculative = 0.25;  ///< of the relative travel in a step: so near is near
/// [m] Gaps are told apart to this; a sweep stops there. Half: depth x0.6; double: depth x2.5.
constexpr double kGapResolution = 1e-4;
constexpr double kNearBody = 0.005;                 ///< [m] what comes this near may touch
constexpr double kFlatStick = 10 * kGapResolution;  ///< [m] flat: a stick's gap varies by less
/// Of a stick: a touch nearer to an end is the particle's; flat contact spans more of an axis.
constexpr double kStickEnd = 0.02;
/// The same of springs, and of rk from event to event: there a touch passes from stick to particle
/// where both are as deep.
constexpr double kEndOfStick = 1e-9;
constexpr double kSameSide = 0.5;  ///< cosine of the most that a normal turns in a motion
/// Of a stick: what moves farther in a motion is another contact.
constexpr double kSamePlace = 0.1;
constexpr double kAlong = 0.9;  ///< cosine: a normal along the stick cannot push it out
constexpr double kParallel = 0.03;  ///< squared sine (10 degrees) below which axes may lie flat

// --- Not tuned: a property of skin and clothes.
constexpr double kBodyFriction = 0.5;  ///< [-] Coulomb coefficient of body on body

}  // namespace ragdoll
