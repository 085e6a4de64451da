// What linear systems are solved by.
// How to read it: direct/constants.h.
#pragma once

#include <cstddef>

namespace ragdoll {

/// Relative error of a squared length. Half, double: stretch in proportion.
constexpr double kLengthTolerance = 1e-10;
/// Of a stick's length, how far an iteration moves its ends; [rad] of a rigid motion: more is lost.
constexpr double kLargestTurn = 0.5;

// --- Projected Gauss-Seidel (schur_sweeps.h).
constexpr double kSweepTolerance = 1e-7;  ///< largest change of an impulse, of the largest impulse
constexpr double kConstant = 0.1;  ///< what two ratios of changes may differ, of 1 less the ratio
/// Below, the sweeps are as fast themselves. 0: x1.3 cost.
constexpr double kLeastRatio = 0.2;

// --- Batches of sweeps, where they alone do not settle (Schur::solveOn, anderson.h).
constexpr int kMemory = 5;  ///< batches that are combined

// --- Not tuned: rounding.
/// As kSweepTolerance, of an impact. At that itself 0.1 N s beside 20 N s were 3 % off.
constexpr double kImpactTolerance = 1e-12;

// --- Not tuned: made of others.
constexpr double kMostRatio = 1 - kConstant / 2;   ///< above, rows may contradict each other
constexpr int kBatch = 2 * kMemory;                ///< [sweeps] what converges fast is then done
constexpr double kShared = 100 * kSweepTolerance;  ///< change of friction as loads are shared

// --- Not tuned: caps, and guards against impulses that grow without end.
constexpr int kMaxSweeps = 100;  ///< most end after 5 to 15
constexpr int kMaxImpactSweeps = 10 * kMaxSweeps;
constexpr int kBatches = 4 * kMemory;
constexpr double kEndless = 1e-3;    ///< what the ratio of changes that do not shrink is off 1
constexpr int kEndlessSweeps = 4;    ///< so many of them: there is no solution
constexpr double kNoChange = 1e-6;   ///< share by which changes of no end differ
constexpr double kMostGrowth = 1e4;  ///< of impulses: rows contradict each other, no use

// --- Not tuned: loads that are shared (equal_springs.h); rounding, and caps.
constexpr double kDependentPush = 1e-11;  ///< what is left of a diagonal of 1
constexpr double kSlides = 1 - 1e-6;      ///< of the disc's radius, at 1 of which friction slides
constexpr int kShareRounds = 4;           ///< solutions in which friction and shares settle
constexpr double kShrinks = 0.5;    ///< of the last change: more, and rows contradict each other
constexpr int kMostLetGo = 2;       ///< contacts, in one sharing, beside those without load
constexpr double kAgreeing = 1e-9;  ///< [m/s] of rows that agree
constexpr std::size_t kMostShared = 256;  ///< rows: the cost of more grows with their cube
constexpr int kMostIdle = 64;  ///< rows, of which what touches without load has a share: likewise

// --- Not tuned: implicit steps (implicit_sticks.h); rounding, and a cap.
constexpr double kBalance = 1e-9;          ///< of the longest stick: positions against multipliers
constexpr double kMotionRounding = 1e-12;  ///< of the motion without sticks: likewise
constexpr double kNoProgress = 1e-12;      ///< share of an iteration's step: less leads nowhere
/// Of kLargestTurn: where a bound for all sticks is below, rounding leaves each of them below it.
constexpr double kSurelyBelow = 0.98;
constexpr int kMaxImplicitNewton = 40;  ///< iterations

// --- Not tuned: the unit in which bodies are large or small.
constexpr double kHumanStick = 0.25;  ///< [m] a usual length

}  // namespace ragdoll
