#include "core/contact/contact.h"

#include <gtest/gtest.h>

namespace ragdoll {
namespace {

/// Of a ball that rolls over what is round, from above it to its side.
Contact rolledOver(double angle) {
  Contact c;
  c.touches_at_start = true;
  c.start_normal = Vec3::UnitZ();
  c.normal = Vec3(std::sin(angle), 0, std::cos(angle));
  return c;
}

Vec3 sumOf(const std::array<Vec3, 3>& directions, const Vec3& components) {
  return components[0] * directions[0] + components[1] * directions[1] +
         components[2] * directions[2];
}

/// An impulse turns with the surface: about y, from z to x.
TEST(Contact, ImpulseTurnsAsTheNormalHas) {
  for (const double angle : {0.0, 0.4, 1.5}) {
    const Contact c = rolledOver(angle);
    const Vec3 components(3, -0.5, 2), world = sumOf(c.atStart().directions(), components);
    const Vec3 turned = Eigen::AngleAxisd(angle, Vec3::UnitY()) * world;
    EXPECT_LT((sumOf(c.directions(), c.turned(components)) - turned).norm(), 1e-14) << angle;
  }
  Contact met = rolledOver(0.4);
  met.touches_at_start = false;
  EXPECT_EQ(met.turned(Vec3(3, -0.5, 2)), Vec3(3, -0.5, 2));
}

/// The way from place to place of a round surface is all slip; what a spring closes by half way is
/// none.
TEST(Contact, SlipOfASpringIsAlongTheSurface) {
  const double angle = 0.4, closes = 0.02;
  Contact c = rolledOver(angle);
  const Vec3 way = 0.5 * (c.normal - c.start_normal);
  const Vec3 moved = way - closes * (c.normal + c.start_normal).normalized();
  EXPECT_EQ(c.slipOf(moved), moved) << "rigid";
  c.give.compliance = 1e-4;
  EXPECT_LT((c.slipOf(moved) - way).norm(), 1e-15);
  c.touches_at_start = false;
  EXPECT_EQ(c.slipOf(moved), moved) << "met on the way";
}

TEST(Contact, GapIsOfTheWeightedPlaces) {
  Contact c;
  c.particle = {0, 2};
  c.weight = {0.25, 0.75};
  c.count = 2;
  c.normal = Vec3(0.6, 0, 0.8);
  c.offset = 0.5;
  Points x(3, 3);
  x << 1, 9, 3, 0, 9, 1, 2, 9, 0;
  EXPECT_LT((c.of(x) - Vec3(2.5, 0.75, 0.5)).norm(), 1e-15);
  EXPECT_NEAR(c.gapAt(x), 0.6 * 2.5 + 0.8 * 0.5 - 0.5, 1e-15);
  EXPECT_EQ(c.storedEnergy(-0.1), 0);
  c.give.compliance = 1e-4;
  EXPECT_DOUBLE_EQ(c.storedEnergy(-0.1), 0.5 * 1e4 * 0.01);
  EXPECT_EQ(c.storedEnergy(0.1), 0);
}

}  // namespace
}  // namespace ragdoll
