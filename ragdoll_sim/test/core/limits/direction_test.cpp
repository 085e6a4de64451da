#include "ragdoll_sim/core/direction.h"

#include <gtest/gtest.h>

#include <random>

namespace ragdoll {
namespace {

TEST(Direction, SwungTakesOneToTheOtherAndKeepsAngles) {
  const Vec3 a = Vec3(1, 2, 3).normalized(), u = Vec3(-2, 1, 0.5).normalized(), v(0.3, -1, 2);
  EXPECT_LT((swung(a, u, a) - u).norm(), 1e-15);
  EXPECT_NEAR(swung(a, u, v).norm(), v.norm(), 1e-15);
  EXPECT_NEAR(swung(a, u, v).dot(u), v.dot(a), 1e-15);
  EXPECT_LT((swung(a, u, a.cross(u)) - a.cross(u)).norm(), 1e-15);  // the smallest rotation
}

TEST(Direction, GradientIsTheDerivativeOfItsValue) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Vec3(uniform(random), uniform(random), uniform(random)); };
  Direction d;  // of a rigid group, carried along two bones
  d.base = {0, 1, 2};
  d.c = Vec3(0.3, 0.5, 0.7);
  d.swings = 2;
  d.swing[0] = {2, 3, Vec3(0.1, 0.9, -0.4)};
  d.swing[1] = {3, 4, Vec3(0.8, -0.2, 0.5)};
  for (int i = 0; i < 20; ++i) {
    Points x(3, 5);
    for (int k = 0; k < 5; ++k) x.col(k) = vector();
    const Vec3 g = vector();
    LimitRow row;
    addGradient(d, g, x.data(), 0, row);
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < row.count; ++k) {
      sum += row.gradient[k];
      for (int axis = 0; axis < 3; ++axis) {
        Points more = x, less = x;
        more(axis, row.particle[k]) += 1e-6;
        less(axis, row.particle[k]) -= 1e-6;
        const double slope = g.dot(valueOf(d, more.data()) - valueOf(d, less.data())) / 2e-6;
        EXPECT_NEAR(row.gradient[k][axis], slope, 1e-5 * (1 + std::abs(slope)));
      }
    }
    EXPECT_LT(sum.norm(), 1e-9);  // no net force
  }
}

}  // namespace
}  // namespace ragdoll
