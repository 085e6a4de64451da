// What the direct methods' step is tuned by. docs/equations.md tells the algorithms that they
// belong to.
// Not here, since not tuned: sizes, guards against rounding, and caps of loops that converge.
#pragma once

namespace ragdoll {

// --- Tolerances: at kCoarseStep or more; below, with the square of the step, as the method's
// error.
constexpr double kCoarseStep = 1.0 / 120;   ///< [s]
constexpr double kContactTolerance = 1e-6;  ///< [m] violation that a solution may leave
constexpr double kTouching = 1e-5;          ///< [m] a gap smaller than that is closed

// --- Candidates: what a motion may meet.
constexpr double kContactMargin = 0.02;  ///< [m] obstacles this near are looked at
/// [m] Contacts nearer than that are solved for at once and make an island; a deeper overlap is
/// more than a sound step leaves.
constexpr double kClose = 1e-3;
constexpr double kSlop = 5e-4;  ///< [m] that a solution may leave; also of overlapping capsules
constexpr double kLever = 0.1;  ///< [m] on which a violated angle is seen as a depth

// --- Depenetration: what overlaps opens slowly, so that nothing is shot out.
constexpr double kRecoverySpeed = 2;  ///< [m/s] of an overlap with an obstacle
constexpr double kRecoveryTurn = 5;   ///< [rad/s] of a violated limit
constexpr double kFarBeyond = 0.02;   ///< [rad] violated by more than steps leave behind

// --- Position and velocity stages.
constexpr int kMaxRounds = 6;        ///< of contacts and sticks in turn
constexpr int kImplicitRounds = 12;  ///< the same of implicit steps, which start farther off
constexpr double kProgress = 0.8;    ///< of the last round's violation: more is no progress
constexpr int kMaxSearches = 3;      ///< for contacts that others push the body into
constexpr double kBounceSteps = 4;   ///< bounce only above an approach speed of 4 g h: else rest
constexpr int kMaxBounces = 4;       ///< in one step; later ones do not bounce

// --- Impacts.
constexpr int kMaxLocated = 8;       ///< in one step; later ones press over their whole substep
constexpr int kMaxDeepImpacts = 32;  ///< likewise of contacts that would reach deep
constexpr double kDeepImpact = 0.2;  ///< [m] for a body of human size
constexpr double kSlowSteps = 2;     ///< what comes slower than gravity in two steps is at rest
constexpr double kLeastPull = 1;     ///< [m/s^2] where gravity is less: other limbs pull, too
constexpr double kLimb = 0.3;        ///< [m] on which gravity turns a limb

// --- Step guard (substep_control.h).
constexpr double kStable = 1.0;           ///< h Omega of a substep; 2: the edge of stability
constexpr double kJump = 0.5;             ///< of kStable, for tension that jumps
constexpr double kSwing = 0.2;            ///< of kStable: below, leapfrog's energy hardly swings
constexpr int kMaxSubsteps = 16;          ///< above, one implicit step is cheaper
constexpr int kMaxDriven = 4;             ///< the same while obstacles or pins move
constexpr int kMaxImplicitSubsteps = 64;  ///< beyond, the rest of the step is one rigid motion

// --- Energy.
/// Of the kinetic energy (1 mJ at least): a substep that gains more is done again at half.
constexpr double kRedoRise = 1e-3;
/// The same of a smooth motion, whose energy should neither rise nor fall, in kinetic energy and a
/// fall of 1 m together: limbs that turn back have none of the first.
constexpr double kRedoSwing = 3e-4;
constexpr double kWildSpeed = 10;  ///< [m/s] that no overlap opens at

// --- Implicit and rigid steps.
constexpr double kLargestShare = 0.5;  ///< of a stick's length: how far an iteration moves its ends
constexpr double kLargestTurn = 1;     ///< [rad] of a rigid motion; faster spin is lost

// --- Lengths and shapes.
constexpr double kNoLength = 1e-3;  ///< of a stick's length: below, it has no direction
constexpr double kSpread = 0.02;    ///< of the rest pose: what gives it one
constexpr double kRecoveryTime =
    0.05;  ///< [s] in which a gap, or an overlap of capsules, shrinks to 1 / e

// --- Adaptive rk.
constexpr double kSafety = 0.9;       ///< of the substep that the estimate allows
constexpr double kLargestGrowth = 4;  ///< from one substep to the next
constexpr double kSmallestGrowth = 0.2;
constexpr double kFailedGrowth = 0.25;  ///< after a motion that was not found

// --- Not tuned: what several files take for rounding.
constexpr double kSnap = 1e-6;          ///< of the substep: nearer to its ends is there
constexpr double kNothingLeft = 1e-9;   ///< of the step: rounding of what was taken
constexpr double kReportedGain = 1e-6;  ///< [J] less is not told

}  // namespace ragdoll
