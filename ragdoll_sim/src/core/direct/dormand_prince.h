// The formula of Dormand and Prince of fifth order in six stages [Dormand1980].
#pragma once

namespace ragdoll::dormand_prince {

constexpr int kStages = 6;
constexpr double kA[kStages][kStages - 1] = {
    {},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656}};
constexpr double kB[kStages] = {35.0 / 384,     0,        500.0 / 1113, 125.0 / 192,
                                -2187.0 / 6784, 11.0 / 84};
/// When in the step each stage is.
constexpr double kC[kStages] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1};
/// Weights of the fifth order less those of the fourth, the last for the stage at the end.
constexpr double kE[kStages + 1] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                    -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

}  // namespace ragdoll::dormand_prince
