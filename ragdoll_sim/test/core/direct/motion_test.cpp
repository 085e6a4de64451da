#include "core/direct/motion.h"

#include <gtest/gtest.h>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Motion, FallsByTheParabola) {
  Scene scene = sceneOf(oneParticle(2));
  scene.ragdolls[0].velocity = Vec3(1, 0, 3);
  DirectIsland one(scene);
  const double h = 0.5 * one.h;
  ASSERT_TRUE(freeMotion(one.body(), h));
  EXPECT_NEAR(one.body().motion.dx(0, 0), h, 1e-15);
  EXPECT_NEAR(one.body().motion.dx(2, 0), 3 * h - 0.5 * 9.81 * h * h, 1e-15);
  makeMotion(one.body(), h, true);
  EXPECT_NEAR(one.world.v(0).z(), 3 - 9.81 * h, 1e-14);
}

/// Two equal balls on a rod of 1 m that turns at 12 rad/s: the chord of SHAKE's circle is h v long
/// across the old direction, and the rod keeps its length and its tension m omega^2 L / 2.
TEST(Motion, TurnsARodThatKeepsItsLength) {
  constexpr double kTurn = 12;
  Scene scene = weightless(oneStick());
  scene.ragdolls[0].angular_velocity = Vec3(0, 0, kTurn);
  DirectIsland one(scene);
  Body& body = one.body();
  ASSERT_TRUE(freeMotion(body, one.h));
  const Points after = body.x() + body.motion.dx;
  EXPECT_NEAR((after.col(1) - after.col(0)).norm(), 1, 1e-10);
  EXPECT_NEAR(body.motion.dx(1, 1), 0.5 * kTurn * one.h, 1e-12);
  makeMotion(body, one.h, true);
  const Vec3 along = (one.world.x(1) - one.world.x(0)).normalized();
  EXPECT_NEAR(along.dot(one.world.v(1) - one.world.v(0)), 0, 1e-10);
}

TEST(Motion, OfARodThatTurnsTooFarIsNotFound) {
  Scene scene = weightless(oneStick());
  scene.ragdolls[0].angular_velocity = Vec3(0, 0, 1e4);
  DirectIsland one(scene);
  EXPECT_FALSE(freeMotion(one.body(), one.h));
}

}  // namespace
}  // namespace ragdoll
