#include "core/direct/runge_kutta.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// Two balls on a rod of 1 m that turn about each other at 5 rad/s: after h the rod has turned by
/// 5 h. Half the step leaves a 64th of the error (or a 32nd, where the sixth power vanishes).
double errorOfSpin(double h) {
  constexpr double kTurn = 5;
  Scene scene = weightless(oneStick());
  scene.ragdolls[0].angular_velocity = Vec3(0, 0, kTurn);
  DirectIsland one(scene);
  Body& body = one.body();
  Points dx(3, 2), v1(3, 2);
  Eigen::VectorXd lambda(body.rows->s);
  rungeKutta(body.memory->response, body.xData(), body.vData(), Points::Zero(3, 2), nullptr, h,
             body.stages, dx, v1, lambda.data());
  const Vec3 middle(0.5, 0, 0);
  const Vec3 right = middle + 0.5 * Vec3(std::cos(kTurn * h), std::sin(kTurn * h), 0);
  return (one.world.x(1) + dx.col(1) - right).norm();
}

TEST(RungeKutta, IsOfFifthOrder) {
  const double coarse = errorOfSpin(0.1), fine = errorOfSpin(0.05);
  EXPECT_LT(coarse, 2e-5);
  EXPECT_GT(coarse / fine, 30);
}

}  // namespace
}  // namespace ragdoll
