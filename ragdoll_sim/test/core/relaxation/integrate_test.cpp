#include "core/relaxation/integrate.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/core/types.h"

namespace ragdoll {
namespace {

/// [m] that a body falls in n steps of h [s] from rest.
double fallen(Integrator integrator, double h, int n) {
  Points x = Points::Zero(3, 1), v = x, a = x;
  a(2, 0) = -9.81;
  for (int i = 0; i < n; ++i) integrateFree(integrator, h, a, x, v);
  EXPECT_NEAR(v(2, 0), -9.81 * h * n, 1e-12);
  return -x(2, 0);
}

TEST(IntegrateFree, FallsAsItsHeaderSays) {
  const double h = 0.02, g = 9.81;
  const int n = 50;
  const double sum = 0.5 * g * h * h * n;
  EXPECT_NEAR(fallen(Integrator::kVerlet, h, n), sum * (n + 1), 1e-12);
  EXPECT_NEAR(fallen(Integrator::kSymplecticEuler, h, n), sum * (n + 1), 1e-12);
  EXPECT_NEAR(fallen(Integrator::kEuler, h, n), sum * (n - 1), 1e-12);
  EXPECT_NEAR(fallen(Integrator::kMidpoint, h, n), sum * n, 1e-12);
  EXPECT_NEAR(fallen(Integrator::kVelocityVerlet, h, n), sum * n, 1e-12);
}

}  // namespace
}  // namespace ragdoll
