#include "core/direct/mode_events.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/mode_body.h"

namespace ragdoll {
namespace {

using namespace test;

/// A whole step.
struct Moved : ModeBody {
  int contacts = -1;
  double error = 0;
  bool moved;

  explicit Moved(const Scene& scene) : ModeBody(scene) {
    moved = moveThroughEvents(island, h, contacts, error);
  }
};

/// With e = 1 the speed after h tells when it landed: v = g t - g (h - t).
TEST(ModeEvents, ABallLandsAfterTheRootOfTwiceItsHeight) {
  const double height = 1e-4;
  Moved ball(modeScene(oneParticle(1, 0.1), Vec3(0, 0, 0.1 + height), floorPlane(0.5, 1)));
  ASSERT_TRUE(ball.moved);
  EXPECT_EQ(ball.contacts, 0);
  const double landed = 0.5 * (ball.world.v(0).z() / kG + ball.h);
  EXPECT_NEAR(landed, std::sqrt(2 * height / kG), 1e-12);
}

/// What slid up a slope slides back after t = v / (g (sin + mu cos)), faster by g (sin - mu cos).
TEST(ModeEvents, ABlockTurnsBackWhenFrictionAndWeightHaveTakenItsSpeed) {
  const Slope slope{0.5};
  const double mu = 0.3, speed = 0.03, steep = std::sin(slope.angle), flat = std::cos(slope.angle);
  Moved block(slope.block(mu, speed));
  ASSERT_TRUE(block.moved);
  EXPECT_EQ(block.contacts, 1);
  const double back = kG * (steep - mu * flat);
  const double stops = block.h + block.world.v(0).dot(slope.up()) / back;
  EXPECT_NEAR(stops, speed / (kG * (steep + mu * flat)), 1e-12);
}

TEST(ModeEvents, ABlockStopsAfterTheSquareOfItsSpeed) {
  const double mu = 0.4, speed = 0.02;
  Moved block(Slope{0}.block(mu, speed));
  ASSERT_TRUE(block.moved);
  EXPECT_LT(block.world.v(0).norm(), 1e-15);
  EXPECT_NEAR(block.world.x(0).x(), speed * speed / (2 * mu * kG), 1e-14);
  EXPECT_TRUE(block.row(0).sticks);
  EXPECT_TRUE(block.body().cache.gripped());
}

/// The next step starts at half the force, as leapfrog's impulses per h^2 are: of each end, its
/// ball's weight. So does the rod's push, none.
TEST(ModeEvents, WhatPressesAtTheEndIsKept) {
  Moved rod(rodOnEnd(0.5, 0, 0));
  ASSERT_TRUE(rod.moved);
  EXPECT_EQ(rod.contacts, 2);
  ASSERT_EQ(rod.body().cache.impulses().size(), 2u);
  for (const CachedImpulse& last : rod.body().cache.impulses())
    EXPECT_LT((last.impulse - 0.5 * kG * Vec3::UnitZ()).norm(), 1e-13);
  EXPECT_NEAR(rod.body().multipliers()[0], 0, 1e-13);
}

/// Whether a body that starts at rest came through; if not, nothing of it has changed.
bool comesThrough(const Scene& scene) {
  Moved ball(scene);
  if (ball.moved) return true;
  EXPECT_EQ(ball.world.x(0), scene.ragdolls[0].pose.position);
  EXPECT_EQ(ball.world.v(0), Vec3(0, 0, 0));
  EXPECT_EQ(ball.body().located, 0);
  return false;
}

/// Of bounces that crowd: from 1e-8 m, with e = 0.985, there are 60 within 3.6 ms. Likewise
/// within a tolerance, and where no events are asked for.
TEST(ModeEvents, WhatIsNotForThemIsLeftAlone) {
  const Vec3 start(0, 0, 0.1 + 1e-8);
  const Scene lands = modeScene(oneParticle(1, 0.1), start, floorPlane());
  Scene crowds = lands, none = lands;
  crowds.obstacles[0].restitution = 0.985;
  none.solver.events = false;
  EXPECT_TRUE(comesThrough(lands));
  EXPECT_FALSE(comesThrough(crowds));
  EXPECT_FALSE(comesThrough(none));
}

TEST(ModeEvents, WhatPassesAnEdgeTooFastToHoldOnFliesOn) {
  // v^2 > g r: the force jumps below zero where the face ends. It ended 2e-6 m from its parabola.
  const double radius = 0.1, passes = 5e-3;
  for (const double speed : {1.0, 1.1, 2.0, 5.0}) {
    ObstacleSpec box;
    box.type = ObstacleSpec::Type::kBox;
    box.size = Vec3(2, 2, 2);
    box.friction = 0;
    Scene scene = modeScene(oneParticle(1, radius), Vec3(1 - passes * speed, 0, 1 + radius), box);
    scene.ragdolls[0].velocity = Vec3(speed, 0, 0);
    ModeBody b(scene);
    int contacts = -1;
    double error = 0;
    ASSERT_TRUE(moveThroughEvents(b.island, b.h, contacts, error)) << speed;
    const double t = b.h - passes;
    EXPECT_EQ(contacts, 0) << speed;
    EXPECT_NEAR(b.world.x(0).x(), 1 + speed * t, 1e-11) << speed;
    EXPECT_NEAR(b.world.x(0).z(), 1 + radius - 0.5 * kG * t * t, 1e-11) << speed;
  }
}

}  // namespace
}  // namespace ragdoll
