// What linear systems are solved by.
// Not here, since not tuned: sizes, guards against rounding, and caps of loops that converge.
#pragma once

namespace ragdoll {

constexpr double kLengthTolerance = 1e-10;  ///< relative error of a squared length
constexpr double kHumanStick = 0.25;        ///< [m] a usual length: other bodies are scaled by it

// --- Projected Gauss-Seidel (schur_sweeps.h).
constexpr double kSweepTolerance = 1e-7;  ///< largest change of an impulse, of the largest impulse
constexpr int kMaxSweeps = 100;           ///< most end after 5 to 15
constexpr int kPatience = 20;             ///< [sweeps] in which the changes have to shrink,
constexpr double kShrinkage = 0.9;        ///< to this share at least
constexpr double kConstant = 0.1;    ///< what two ratios of changes may differ, of 1 less the ratio
constexpr double kLeastRatio = 0.2;  ///< below, the sweeps are as fast themselves
constexpr double kMostRatio = 0.95;  ///< above, impulses may be growing, and would by leaps
constexpr double kEndless = 1e-3;    ///< what the ratio of changes that do not shrink is off 1
constexpr int kEndlessSweeps = 4;    ///< so many of them: impulses grow without end, no solution

// --- Batches of sweeps, where they alone do not settle (schur.cpp).
constexpr int kBatch = 10;     ///< [sweeps] what converges fast is then done
constexpr int kBatches = 20;   ///< at most
constexpr int kMemory = 5;     ///< batches that are combined
constexpr double kWorse = 2;   ///< a change so much larger than the last: they mislead
constexpr double kMost = 1e4;  ///< times as large: of rows that contradict each other, no use

}  // namespace ragdoll
