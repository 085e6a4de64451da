// What numbers can follow: a position, a length, a speed or a force beyond is refused where it
// enters. What a run makes of those that are within is left to the step guard.
#pragma once

#include <string>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// [m] of each coordinate and each length. Doubles are 1e-7 m apart there, and by the direct
/// methods bodies fall, rest and sleep as at the origin; ten times as far out the step guard acts
/// in a tenth of the steps, at 1e11 m sticks miss their lengths by 2e-3, at 1e15 m they have none
/// (docs/extremes.md).
constexpr double kFarthest = 1e9;

/// [m/s]. After a second at it positions are known to a micrometre no longer, and sticks have no
/// length.
constexpr double kFastest = 1e10;

/// [m], [m/s] of a saved state: a run may go on beyond the bounds above, and what it saves is to be
/// restored. It never comes here, where squares and cubes are still numbers.
constexpr double kLargestState = 1e100;

/// Whether each coordinate is a number within kFarthest.
bool isWithinReach(const Vec3& position);

/// Throws Error(where, "<subject> [x, y, z] m; ...") if it is not.
void checkPosition(const std::string& where, const Vec3& position,
                   const std::string& subject = "is");

/// Throws Error if it is not in [0, kFarthest].
void checkLength(const std::string& where, double length);

/// Throws Error if it is faster than kFastest, or no number.
void checkSpeed(const std::string& where, const Vec3& velocity);

/// Throws Error if it would give, in one step of h [s], more than kFastest.
void checkGravity(const std::string& where, const Vec3& gravity, double h);

/// A tolerance [m] below that is rounding's; 0 is none.
constexpr double kSmallestTolerance = 1e-12;
void checkTolerance(const std::string& where, double tolerance);

/// Threads of a step, or of a crowd's; 0: all cores. Throws Error.
constexpr int kMaxThreads = 256;
void checkThreads(const std::string& where, int threads);

/// Throws Error("force", ...) if the poke would give its ragdoll, in one step, more than kFastest.
/// An offset counts by the body's size.
void checkForce(const Model& model, const Poke& poke);

}  // namespace ragdoll
