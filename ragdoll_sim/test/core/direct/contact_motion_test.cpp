#include "core/direct/contact_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// Of the middles of a chain's two sticks, as if they were surfaces.
Contact betweenTheSticks(int first) {
  Contact c;
  c.count = 4;
  c.particle = {first, first + 1, first + 1, first + 2};
  c.weight = {0.5, 0.5, -0.5, -0.5};
  c.normal = Vec3(0.6, 0, 0.8);
  c.offset = 0.07;
  return c;
}

Scene twoChains() {
  Scene scene = weightless(chainOfThree(), Vec3(1, 2, 3));
  scene.ragdolls.push_back(scene.ragdolls[0]);
  scene.ragdolls[1].name = "other";
  scene.ragdolls[1].pose.position = Vec3(0.3, 0.2, 1);
  return scene;
}

TEST(ContactMotion, GapsAreThoseOfThePlaceThatIsReached) {
  DirectIsland two(twoChains());
  for (Body* body : two.island.bodies) body->motion.dx = Points::Random(3, 3);
  Contact own = betweenTheSticks(3), pair = own;
  own.ragdoll = 1;
  pair.particle = {0, 1, 4, 5};
  pair.other = 1;
  Points end = two.world.state.x;
  for (const Body* body : two.island.bodies) end.middleCols(body->first, 3) += body->motion.dx;
  EXPECT_NEAR(gapAfter(*two.island.bodies[1], own), own.gapAt(end), 1e-15);
  EXPECT_NEAR(gapAfter(two.island, pair), pair.gapAt(end), 1e-15);
  pair.other = 7;  // that does not move
  for (const int i : {4, 5}) end.col(i) = two.world.state.x.col(i);
  EXPECT_NEAR(gapAfter(two.island, pair), pair.gapAt(end), 1e-15);
}

/// What turns by the angle phi about an axis a moves by 2 tan(phi / 2) a x of the place half way.
TEST(ContactMotion, WhatTurnsAsOneDoesNotSlip) {
  DirectIsland two(twoChains());
  Body& body = two.body();
  const double phi = 0.4;
  const Vec3 axis = Vec3(1, 2, -2) / 3;
  const Eigen::Matrix3d turned(Eigen::AngleAxisd(phi, axis));
  body.motion.dx = turned * body.x() - body.x();
  const Contact c = betweenTheSticks(0);
  EXPECT_GT(slipAfter(body, c, Vec3::Zero()).norm(), 0.2);
  EXPECT_LT(slipAfter(body, c, 2 * std::tan(phi / 2) * axis).norm(), 1e-15);
}

TEST(ContactMotion, RatesAreAgainstTheOtherSurface) {
  DirectIsland two(twoChains());
  Contact c = betweenTheSticks(0);
  c.count = 1;
  c.weight = {1};
  c.obstacle = 0;
  c.surface_end = two.h * Vec3(1, 0, 0);
  EXPECT_LT((rateOf(two.context, c) - Vec3(0, 2, 3)).norm(), 1e-15);
  EXPECT_NEAR(openingRate(two.context, c), 2.4, 1e-15);
}

}  // namespace
}  // namespace ragdoll
