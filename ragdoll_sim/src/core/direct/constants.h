// What the direct methods' step is tuned by. docs/equations.md tells the algorithms that they
// belong to.
// Tuned ones first. Half and double of each break no law of 300 random scenes, 60 piles and 60
// driven scenes (ragdoll_lab extremes --random-only); unless it says more, their worst rise of
// energy stays within a factor of 1.4, depth below 0.1 mm, and cost within 10 %. Those that are not
// tuned, after a line that says so: sizes, guards against rounding, caps of loops that converge,
// the literature's, and what is made of another constant.
#pragma once

namespace ragdoll {

// --- Tolerances: at kCoarseStep or more; below, with the square of the step, as the method's
// error.
constexpr double kCoarseStep = 1.0 / 120;   ///< [s]
constexpr double kContactTolerance = 1e-6;  ///< [m] violation that a solution may leave

// --- Candidates: what a motion may meet. Obstacles are looked at within kNearBody.
/// [m] Contacts nearer than that are solved for at once and make an island; a deeper overlap is
/// more than a sound step leaves.
constexpr double kClose = 1e-3;
constexpr double kLever = 0.1;  ///< [m] on which angles count as lengths, and gravity turns

// --- Depenetration: what overlaps opens slowly, so that nothing is shot out.
constexpr double kRecoverySpeed = 2;    ///< [m/s] of an overlap with an obstacle
constexpr double kRecoveryTurn = 5;     ///< [rad/s] of a violated limit
constexpr double kRecoveryTime = 0.05;  ///< [s] in which gaps and overlaps shrink to 1 / e

// --- Position and velocity stages.
constexpr double kProgress = 0.9;  ///< of the last round's violation: more is no progress

// --- Impacts.
constexpr double kRestSteps = 4;  ///< what comes slower than gravity in four steps is at rest
constexpr double kLimb = 0.6;     ///< [m] on which gravity turns a limb. 0.1: shake loses its order
/// [m/s^2] Where gravity is less. 1: in zero gravity nothing bounces below 33 mm/s at 120 Hz.
constexpr double kLeastPull = 0.01;
/// Of the weight, at kCoarseStep: less friction is not worth a shorter motion where its slip turns.
/// Two thirds: 6 % more cost of a fall.
constexpr double kWorthATurn = 0.15;
constexpr int kMaxLocated = 8;  ///< in one step; later ones press over their whole substep

// --- Step guard (substep_control.h).
/// h Omega of a substep; 2: the edge of stability. Half: x1.2 cost; double: energy rises x4, of
/// piles x1.6.
constexpr double kStable = 1.0;
/// Of kStable: below, energy hardly swings. Double: energy rises x4, of piles x1.6.
constexpr double kSwing = 0.2;
/// Of kStable: below, no jump of tension counts. 0.2: shake converges at order 1.91 onto a stop.
/// Half: depth of piles x1.5.
constexpr double kJump = 0.5;
constexpr int kMaxSubsteps = 16;  ///< above, one implicit step is cheaper
/// Of the kinetic energy (0.3 mJ at least): a substep that gains more is done again at half. Of a
/// smooth motion, whose energy should neither rise nor fall, in kinetic energy and a fall of 1 m
/// together: limbs that turn back have none of the first. Double: energy of piles rises x1.7.
constexpr double kRedoGain = 3e-4;
/// Of the kinetic energy: more than friction between limbs gives back in a step.
constexpr double kMostGiven = 0.01;

// --- Adaptive steps.
/// Of leapfrog's defect: the error. Of 79, 79 and 70 windows of contact at 1e-2, 1e-3 and 1e-4 m/s
/// 1, 3 and 4 are off; half: 3, 4 and 5, for a fifth less; double: 1, 2 and 3, for a third more.
constexpr double kOfDefect = 6;
/// [s] at a tolerance of 1 m/s; shorter with its square root, as of a method of second order. 5e-3,
/// 3e-3: of 49 windows of contact at 1e-6 m/s 43, 41 are kept (46), for 14, 42 % more parts.
constexpr double kShortestPart = 7e-3;
constexpr double kReserved = 0.5;       ///< of the tolerance, for the parts that follow in a step
constexpr double kLeastOfOrder = 0.25;  ///< of the order: a shorter part that gains less is in vain

// --- Not tuned: made of others.
/// Of a part times the velocity that a spring has given in it: what the trapezoidal rule errs by of
/// a force that grows from nothing, h dv / 2 for h dv / 3.
constexpr double kOfKick = 1.0 / 6;
constexpr double kTouching = 10 * kContactTolerance;  ///< [m] a gap smaller than that is closed
constexpr double kSlop = kClose / 2;  ///< [m] a solution may leave; also of overlapping capsules
constexpr double kRestsWithin = 2 * kClose;  ///< [m] what a sleeper presses on is nearer
/// [m/s] of an overlap with an obstacle that follows a frame of others: it jumps onto a limb in the
/// midst of a run, and the limb's end is whipped faster (60 random runs: with 1 to 2.1, with 2 to
/// 4.2).
constexpr double kFollowedRecoverySpeed = kRecoverySpeed / 2;
constexpr double kWildSpeed = 5 * kRecoverySpeed;       ///< [m/s] that no overlap opens at
constexpr double kDeepImpact = 2 * kLever;              ///< [m] for a body of human size
constexpr int kMaxDeepImpacts = 4 * kMaxLocated;        ///< of contacts that would reach so deep
constexpr int kMaxDriven = kMaxSubsteps / 4;            ///< while obstacles or pins move
constexpr int kMaxImplicitSubsteps = 4 * kMaxSubsteps;  ///< beyond: one rigid motion
/// Of a failed implicit substep: kMaxImplicitSubsteps after three.
constexpr double kImplicitRetry = 0.25;
constexpr double kJumped = 4;  ///< of the tension, Omega^2: has doubled its frequency
/// [s] sqrt(kLever / g): as long an error of velocities moves a limb before gravity turns it, so
/// that it counts as one of positions.
constexpr double kSwingTime = 0.1;
/// [s] Of longer parts rk's estimate says less. Without: 28 of 1437 runs err tenfold; with: 3.
constexpr double kLongFreePart = kSwingTime / 10;

// --- Not tuned: the literature's.
/// Of the tolerance, what a part aims at, so that most stand at once [Hairer1993, II.4].
constexpr double kAim = 0.38;
constexpr double kLargestGrowth = 4;  ///< from one part to the next; its inverse the smallest
/// Of the step: parts that would have to be shorter take more solutions than a quarter of a step
/// each (kLargestGrowth) in one and in two halves, three: where nothing is met they are taken so.
/// An 8th, a 12th, a 16th: hang at 1e-2 m/s costs 1.57, 1.39, 1.32 times what a fixed step with the
/// same error does, weightless at 1e-3 m/s 1.40, 1.46, 1.58.
constexpr double kLongPart = 1 / (3 * kLargestGrowth);
constexpr int kOrderOfRk = 4;     ///< of the embedded estimate's error per second
constexpr int kOrderOfShake = 2;  ///< likewise of step doubling
constexpr double kDoubling = 3;   ///< 2^2 - 1: the difference over the halves' error

// --- Not tuned: caps.
/// Of contacts and sticks in turn. Half: nothing but 7 % less cost; double: 3 % more.
constexpr int kMaxRounds = 6;
constexpr int kImplicitRounds = 2 * kMaxRounds;  ///< implicit steps start farther off
constexpr int kRecoverySweeps = 60;              ///< of relaxation, where Newton's method fails
constexpr int kMaxSearches = 3;                  ///< for contacts that others push the body into
constexpr int kMaxInVain = 2;                ///< in a row: the motion has a jump or a fork there
constexpr int kMaxUnknown = 2 * kMaxInVain;  ///< where the guard acts, or nothing is found
constexpr int kMaxShortenings = 30;          ///< of a rigid motion that touches
constexpr int kRefinements = 3;              ///< of the time at which something is reached
constexpr int kAffineEvery = 256;  ///< [steps] rigid groups are put back into shape: of rounding

// --- Not tuned: a choice in a last resort.
/// Of the deepest overlap: a body that pins drag on is dragged through what it is in by more.
constexpr double kFilteredDepth = 0.5;

// --- Not tuned: rounding, in single stages.
constexpr double kPartEnd = 1e-12;           ///< of a step: nearer to its ends is there
constexpr double kAbout = 0.01;              ///< of a substep: less longer or shorter is as long
constexpr double kPositionRounding = 4e-15;  ///< relative, with some room
constexpr double kWhole = 1e-6;          ///< relative error of a squared length: none to restore
constexpr double kWholeTolerances = 10;  ///< likewise, of the tolerance far from the origin
constexpr double kTouchDepth = 1e-7;     ///< [m] a rigid motion may end in an obstacle by that
constexpr double kRigidGain = 1e-9;      ///< of the energy: less is no rise by a rigid motion
constexpr double kNothingLost = 1e-15;   ///< of the angular momentum: less lost is nothing lost
constexpr double kContradiction = 1e-9;  ///< [m/s] of velocities at a start: less is none
constexpr double kLeastSlip = 1e-6;      ///< [m/s] of friction that the log completes
constexpr double kLockedAnswer = 1e-9;  ///< of the body's inverse mass: what answers less is locked

// --- Not tuned: rounding.
constexpr double kLeastGain = 1e-9;     ///< as kRedoGain: less stays in the motion
constexpr double kShortEnough = 1.01;   ///< of the shortest part
constexpr double kUnknownRate = 1e300;  ///< [m/s] where no motion was found
constexpr double kTurned = 1e-9;        ///< [rad] of a plane: more than rounding
constexpr double kAtEdge = 1e-7;        ///< [m] nearer to it is on it
constexpr double kStillSlides = 1e-3;   ///< of a slip: more left of it has not ended
constexpr double kAcross = 1e-3;        ///< of friction: less is missing along a slip that goes on
constexpr double kSlidesBack = 1.01;    ///< of friction: less that drives a slip hardly moves it
constexpr double kStruckAtEnd = 10;     ///< of the halves' difference: by velocities, over the part
constexpr double kParting = 1e-5;       ///< [m/s] what leaves slower after an impact stays
constexpr double kSnap = 1e-6;          ///< of the substep: nearer to its ends is there
constexpr double kNothingLeft = 1e-9;   ///< of the step: rounding of what was taken

}  // namespace ragdoll
