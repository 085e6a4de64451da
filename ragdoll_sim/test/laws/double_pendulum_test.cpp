// Two rods with segment inertia, hinged together and hung up, against their Lagrangian.
#include "support/double_pendulum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace ragdoll::test::double_pendulum {
namespace {

/// [m] of the free end after kSeconds at so many steps per second.
double tipError(Method method, int rate, bool lumped = false) {
  static const Vec3 exact = tipByLagrangian(8192);
  World world(pendulum(method, 1.0 / rate, lumped));
  world.steps(static_cast<int>(kSeconds * rate));
  return (world.x(2) - exact).norm();
}

/// Least-squares slope of log error over log step.
double orderOfTheTip(Method method, const std::vector<int>& per_second) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const int rate : per_second) {
    const double x = -std::log(rate), y = std::log(tipError(method, rate));
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double n = static_cast<double>(per_second.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

TEST(DoublePendulum, ReferenceHasConvergedAtFourthOrder) {
  const Vec3 exact = tipByLagrangian(65536);
  const double coarse = (tipByLagrangian(1024) - exact).norm();
  EXPECT_NEAR(std::log2(coarse / (tipByLagrangian(2048) - exact).norm()), 4, 0.2);
  EXPECT_LT((tipByLagrangian(8192) - exact).norm(), 1e-12);
}

TEST(DoublePendulum, ShakeMeetsTheLagrangianAtSecondOrder) {
  EXPECT_LT(tipError(Method::kShake, 1000), 5e-5);
  EXPECT_LT(tipError(Method::kShake, 16000), 2e-7);
  EXPECT_NEAR(orderOfTheTip(Method::kShake, {480, 960, 1920, 3840}), 2, 0.05);
}

TEST(DoublePendulum, RungeKuttaMeetsItAtFifth) {
  EXPECT_LT(tipError(Method::kRk, 60), 2e-5);
  EXPECT_LT(tipError(Method::kRk, 1000), 2e-11);
  EXPECT_NEAR(orderOfTheTip(Method::kRk, {60, 120, 240, 480}), 5, 0.3);
}

TEST(DoublePendulum, AdaptiveRungeKuttaKeepsToItsToleranceAtAnyStep) {
  const Vec3 exact = tipByLagrangian(65536);
  for (const int rate : {4, 15, 60}) {
    int last_substeps = 0;
    for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8}) {
      Scene scene = pendulum(Method::kRk, 1.0 / rate);
      scene.solver.tolerance = tolerance;
      World world(scene);
      int substeps = 0;
      for (int i = 0; i < rate; ++i) substeps += world.steps(1).substeps;
      const double error = (world.x(2) - exact).norm();
      // What is kept to is the error that is made; the motion carries it on and lets it grow.
      EXPECT_LT(error, 3 * tolerance * kSeconds) << rate << " steps per second";
      EXPECT_GT(error, tolerance * 1e-4) << "more work than asked for";
      EXPECT_GE(substeps, last_substeps);
      EXPECT_GE(substeps, rate);
      last_substeps = substeps;
    }
    EXPECT_GT(last_substeps, 100);
  }
}

TEST(DoublePendulum, RelaxationWithTheSameMassMatrixMeetsItAtFirst) {
  EXPECT_LT(tipError(Method::kJakobsen, 15360), 1e-2);
  EXPECT_NEAR(orderOfTheTip(Method::kJakobsen, {3840, 7680, 15360}), 1, 0.05);
}

TEST(DoublePendulum, LumpedMassesMissItAtEveryStep) {
  for (const int rate : {60, 1000, 16000})
    EXPECT_GT(tipError(Method::kShake, rate, true), 0.2) << rate << " per second";
}

}  // namespace
}  // namespace ragdoll::test::double_pendulum
