#include "core/direct/velocity_solver.h"

#include <gtest/gtest.h>

#include "core/direct/candidates.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// A ball that touches the floor and comes down at an angle.
struct Touching : DirectIsland {
  static constexpr double kRadius = 0.1;

  Touching(double restitution, double friction, const Vec3& v)
      : DirectIsland(scene(restitution, friction)) {
    body().v().col(0) = v;
    body().motion.dx.setZero(3, 1);
    findCandidates(island, h);
    findTouching(body(), 0);
  }
  static Scene scene(double restitution, double friction) {
    Scene scene = weightless(oneParticle(2, kRadius));
    scene.ragdolls[0].pose.position.z() = kRadius;
    scene.obstacles = {floorPlane(friction, restitution)};
    return scene;
  }
};

TEST(VelocitySolver, BouncesByNewtonsLaw) {
  Touching one(0.6, 0, Vec3(2, 0, -5));
  ASSERT_EQ(one.body().touching.contacts.size(), 1U);
  bounce(one.island);
  EXPECT_NEAR(one.world.v(0).z(), 3, 1e-12);
  EXPECT_NEAR(one.world.v(0).x(), 2, 1e-12);
}

TEST(VelocitySolver, FrictionTakesNoMoreThanTheCone) {
  Touching slips(0.5, 0.2, Vec3(4, 0, -5)), sticks(0.5, 0.2, Vec3(1, 0, -5));
  bounce(slips.island);
  EXPECT_NEAR(slips.world.v(0).x(), 4 - 0.2 * 1.5 * 5, 1e-12);
  bounce(sticks.island);
  EXPECT_NEAR(sticks.world.v(0).x(), 0, 1e-12);
}

TEST(VelocitySolver, WhatPressesDoesNotBounce) {
  Touching one(0.6, 0, Vec3(0, 0, -1e-3));
  one.body().memory->response.setEnd(one.body().xData());
  solveVelocities(one.island, Stage::kMotion, 0, 0);
  EXPECT_NEAR(one.world.v(0).z(), 0, 1e-12);
}

}  // namespace
}  // namespace ragdoll
