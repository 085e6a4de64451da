// Free motion of one step: positions and velocities under forces, before any constraint.
//
// All are written for (x, v), constant acceleration a over the step h. Position Verlet's x_prev is
// x - h v, so Verlet and symplectic Euler are one formula here, and midpoint and velocity Verlet
// are another as long as a does not depend on x; [Pascucci2007, sec. 3.2], [Jakobsen2001, sec. 2].
// What a body falls in n steps from rest: verlet, symplectic_euler  g h^2 n (n + 1) / 2;
// euler  g h^2 n (n - 1) / 2;  midpoint, velocity_verlet  g h^2 n^2 / 2 (exact).
#pragma once

#include "ragdoll_sim/core/scene.h"

namespace ragdoll {

/// x, v: 3 x n, in place. a: 3 x n [m/s^2]. h: [s].
template <class X, class V, class A>
void integrateFree(Integrator integrator, double h, const A& a, X&& x, V&& v) {
  switch (integrator) {
    case Integrator::kVerlet:
    case Integrator::kSymplecticEuler:
      v += h * a;
      x += h * v;
      return;
    case Integrator::kEuler:
      x += h * v;
      v += h * a;
      return;
    case Integrator::kMidpoint:
    case Integrator::kVelocityVerlet:
      x += h * v + (0.5 * h * h) * a;
      v += h * a;
      return;
  }
}

}  // namespace ragdoll
