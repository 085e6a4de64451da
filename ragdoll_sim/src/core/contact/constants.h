// What contacts are found by.
// Not here, since not tuned: sizes, guards against rounding, and caps of loops that converge.
#pragma once

namespace ragdoll {

constexpr double kBodyFriction = 0.5;    ///< [-] Coulomb coefficient of body on body
constexpr double kSpeculative = 0.25;    ///< of the relative travel in a step: so near is near
constexpr double kGapResolution = 1e-4;  ///< [m] gaps are told apart to this; a sweep stops there
constexpr double kNearBody = 0.005;      ///< [m] a body that comes this near may touch
constexpr double kFlatStick = 1e-3;      ///< [m] a stick lies flat where its gap varies by less
constexpr double kFlatEdge = 1e-6;       ///< [m] the same along an edge, beside which it is round
constexpr double kStickEnd = 0.02;       ///< of a stick: a touch nearer to an end is the particle's
constexpr double kParallel = 0.03;  ///< squared sine (10 degrees) below which axes may lie flat
constexpr double kFlatShare = 0.1;  ///< of the first axis that flat contact must span

}  // namespace ragdoll
