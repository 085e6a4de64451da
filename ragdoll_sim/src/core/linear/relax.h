// Relaxation of sticks, the thesis's and Jakobsen's constraint solver [Jakobsen2001, sec. 4-5].
//
// C = |d| - L, d = x_b - x_a; each stick in turn is brought to its length along its present
// direction, the correction shared by inverse mass. First order in time and dissipative
// (docs/equations.md).
#pragma once

#include <cmath>
#include <vector>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// One sweep over one body. x: its first particle's coordinates, xyz per particle.
/// Coincident ends are parted along x, so that no direction is ever undefined.
inline void relaxSticks(const std::vector<RelaxedStick>& sticks, double* x) {
  for (const RelaxedStick& k : sticks) {
    double* a = x + 3 * k.a;
    double* b = x + 3 * k.b;
    double dx = b[0] - a[0];
    const double dy = b[1] - a[1], dz = b[2] - a[2];
    double length = std::sqrt(dx * dx + dy * dy + dz * dz);
    if (length < kMinLength) dx = length = kMinLength;
    const double c = 1 - k.length / length;
    const double ca = c * k.share_a, cb = c * k.share_b;
    a[0] += ca * dx;
    a[1] += ca * dy;
    a[2] += ca * dz;
    b[0] -= cb * dx;
    b[1] -= cb * dy;
    b[2] -= cb * dz;
  }
}

/// One sweep over one body whose mass matrix couples its particles: the correction d c of a stick
/// moves every particle by its column of b W. X: 3 x n. BW: s x n. G: diagonal of B W B^T, 0:
/// cannot move.
template <class Sticks, class X>
void relaxCoupledSticks(const Sticks& sticks, const Eigen::MatrixXd& BW, const Eigen::VectorXd& G,
                        X&& x) {
  for (std::size_t i = 0; i < sticks.size(); ++i) {
    if (!(G[i] > 0)) continue;
    Vec3 d = x.col(sticks[i].b) - x.col(sticks[i].a);
    double length = d.norm();
    if (length < kMinLength) d = Vec3(length = kMinLength, 0, 0);
    x.noalias() += ((sticks[i].length / length - 1) / G[i] * d) * BW.row(i);
  }
}

}  // namespace ragdoll
