// What the direct methods' step is tuned by. docs/equations.md tells the algorithms that they
// belong to.
// Not here, since not tuned: sizes, guards against rounding, and caps of loops that converge.
#pragma once

namespace ragdoll {

// --- Tolerances: at kCoarseStep or more; below, with the square of the step, as the method's
// error.
constexpr double kCoarseStep = 1.0 / 120;   ///< [s]
constexpr double kFinestShare = 1e-3;       ///< as small as tolerances get: rounding is near
constexpr double kContactTolerance = 1e-6;  ///< [m] violation that a solution may leave
constexpr double kTouching = 1e-5;          ///< [m] a gap smaller than that is closed
constexpr double kTouchingAngle = 1e-4;     ///< [rad] likewise

// --- Candidates: what a motion may meet.
constexpr double kContactMargin = 0.02;  ///< [m] obstacles this near are looked at
constexpr double kActiveGap = 1e-3;      ///< [m] nearer than this a contact is solved for at once
constexpr double kActiveAngle = 0.01;    ///< [rad] likewise a limit
constexpr double kMissed = 1e-4;         ///< [m] deeper than that is found and solved again
constexpr double kMissedStick = 5e-4;    ///< [m] the same of sticks that turned over an edge
constexpr double kPairSlop = 5e-4;       ///< [m] overlap of two capsules that may stay
constexpr double kLever = 0.1;           ///< [m] on which a violated angle is seen as a depth

// --- Depenetration: what overlaps opens slowly, so that nothing is shot out.
constexpr double kRecoverySpeed = 2;        ///< [m/s] of an overlap with an obstacle
constexpr double kRecoveryTurn = 5;         ///< [rad/s] of a violated limit
constexpr double kFarBeyond = 0.02;         ///< [rad] violated by more than steps leave behind
constexpr double kPairRecoveryTime = 0.05;  ///< [s] in which that of capsules shrinks to 1 / e
constexpr double kSoundOverlap = 1e-3;      ///< [m] more than a sound step leaves

// --- Position and velocity stages.
constexpr int kMaxRounds = 6;        ///< of contacts and sticks in turn
constexpr int kImplicitRounds = 12;  ///< the same of implicit steps, which start farther off
constexpr double kProgress = 0.8;    ///< of the last round's violation: more is no progress
constexpr int kMaxSearches = 3;      ///< for contacts that others push the body into
constexpr double kUnsettled = 5e-4;  ///< [m] a solution that leaves more is refused
constexpr double kBounceSteps = 4;   ///< bounce only above an approach speed of 4 g h: else rest
constexpr int kMaxBounces = 4;       ///< in one step; later ones do not bounce

// --- Impacts.
constexpr int kMaxLocated = 8;       ///< in one step; later ones press over their whole substep
constexpr int kMaxDeepImpacts = 32;  ///< likewise of contacts that would reach deep
constexpr double kDeepImpact = 0.2;  ///< [m] for a body of human size
constexpr double kSlowSteps = 2;     ///< what comes slower than gravity in two steps is at rest
constexpr double kLeastPull = 1;     ///< [m/s^2] where gravity is less: other limbs pull, too
constexpr double kLimb = 0.3;        ///< [m] on which gravity turns a limb
constexpr int kRefinements = 3;      ///< of the time at which rk arrives
constexpr double kSnap = 1e-6;       ///< of the substep: nearer to its ends is there

// --- Step guard (substep_control.h).
constexpr double kStable = 1.0;           ///< h Omega of a substep; 2: the edge of stability
constexpr double kJump = 0.5;             ///< of kStable, for tension that jumps
constexpr double kSwing = 0.2;            ///< of kStable: below, leapfrog's energy hardly swings
constexpr int kMaxSubsteps = 16;          ///< above, one implicit step is cheaper
constexpr int kMaxDriven = 4;             ///< the same while obstacles or pins move
constexpr int kMaxImplicitSubsteps = 64;  ///< beyond, the rest of the step is one rigid motion
constexpr double kNothingLeft = 1e-9;     ///< of the step: rounding of what was taken

// --- Energy.
/// Of the kinetic energy (1 mJ at least): a substep that gains more is done again at half.
constexpr double kRedoRise = 1e-3;
/// The same of a smooth motion, whose energy should neither rise nor fall, in kinetic energy and a
/// fall of 1 m together: limbs that turn back have none of the first.
constexpr double kRedoSwing = 3e-4;
constexpr double kWildSpeed = 10;         ///< [m/s] that no overlap opens at
constexpr double kReportedGain = 1e-6;    ///< [J] less is rounding
constexpr double kEnergyRounding = 1e-9;  ///< of the energy: less is no rise

// --- Implicit and rigid steps.
constexpr int kMaxImplicitNewton = 40;  ///< iterations
constexpr double kLargestShare = 0.5;  ///< of a stick's length: how far an iteration moves its ends
constexpr double kSmallShare = 0.49;   ///< below, by a bound, no stick needs to be looked at
constexpr double kBalance = 1e-9;      ///< of the longest stick: positions against multipliers
constexpr double kLargestTurn = 1;     ///< [rad] of a rigid motion; faster spin is lost
constexpr int kMaxShortenings = 30;    ///< of a rigid motion that touches
constexpr double kTouchDepth = 1e-7;   ///< [m] a rigid motion may end in an obstacle by that

// --- Lengths and shapes.
constexpr int kAffineEvery = 256;       ///< [steps] rigid groups are put back into shape
constexpr double kWhole = 1e-6;         ///< relative error of a squared length: none to restore
constexpr double kRecoveryTime = 0.05;  ///< [s] in which a gap shrinks to 1 / e
constexpr double kNoLength = 1e-3;      ///< of a stick's length: below, it has no direction
constexpr double kSpread = 0.02;        ///< of the rest pose: what gives it one
constexpr double kPositionRounding = 4e-15;  ///< relative, with some room
constexpr int kRecoverySweeps = 60;          ///< of relaxation, where Newton's method fails

// --- Adaptive rk.
constexpr int kMaxAdaptive = 1024;    ///< substeps of one step; as small as they get
constexpr double kSafety = 0.9;       ///< of the substep that the estimate allows
constexpr double kLargestGrowth = 4;  ///< from one substep to the next
constexpr double kSmallestGrowth = 0.2;
constexpr double kFailedGrowth = 0.25;  ///< after a motion that was not found

// --- Islands.
constexpr int kIslandRounds = 4;         ///< of islands that grow
constexpr double kIslandMargin = 0.005;  ///< [m] bodies this near are looked at
constexpr double kIslandGap = 1e-3;      ///< [m] bodies that would come nearer make an island

}  // namespace ragdoll
