// A spring between one particle and a point in the world: how a hand pulls at a body.
//
// The particle is to move as if it were alone, on a critically damped spring: a = w^2 (target - x)
// - 2 w v. What force that takes depends on what hangs on the particle, and on the direction: a
// hand is light, but along a stretched arm it is as heavy as the body. f = A^-1 a with the mobility
// A, the inverse of the operational space inertia [Khatib1987, eq. 51]; docs/equations.md#pulls.
#pragma once

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// [1/s] w: of the way to the target, 2 % are left after 0.39 s; gravity g draws it g / w^2 = 44 mm
/// off.
constexpr double kPullRate = 15;
constexpr double kPullReach = 0.5;  ///< [m] a target farther away pulls as if it were this far

/// [1/kg] 3 x 3: acceleration of the particle (column of the state) by a force on it alone, with
/// its body's sticks and pins holding. Joint limits and contacts are not seen.
Eigen::Matrix3d mobility(const Model& model, const State& state, int particle);

/// [N] of the spring during the next step, computed as an implicit step would, so that any length
/// of step is stable. Zero for a particle that is pinned.
Vec3 pullForce(const Model& model, const State& state, int particle, const Vec3& target);

}  // namespace ragdoll
