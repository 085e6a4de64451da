// One limit from the values of its directions, for who knows them already. Private to the core.
#pragma once

#include "ragdoll_sim/core/limits.h"

namespace ragdoll {

/// [rad] C of a limit whose reference and child are r and w; x: coordinates of the body's first
/// particle.
double limitValue(const Limit& limit, const Vec3& r, const Vec3& w, const double* x);

/// Its value and gradient into a row; first: the body's first column of the state.
void evaluateLimit(const Limit& limit, const Vec3& r, const Vec3& w, const double* x, int first,
                   LimitRow& row);

}  // namespace ragdoll
