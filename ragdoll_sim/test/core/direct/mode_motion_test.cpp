#include "core/direct/mode_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/mode_body.h"

namespace ragdoll {
namespace {

using namespace test;

/// An end of a rod of two balls answers along the rod as both, across it as its own ball.
TEST(ModeMotion, AnEndOfARodAnswersByItsTilt) {
  const double tilt = 0.6, s2 = std::pow(std::sin(tilt), 2), c2 = 1 - s2;
  ModeBody rod(rodOnEnd(0.5, tilt, 0));
  rod.close();
  rod.row(0).presses = rod.row(0).sticks = true;
  ModeSystem system;
  ASSERT_TRUE(buildModeSystem(rod.island, rod.now().x.data(), rod.now().v.data(), true, system));
  ASSERT_EQ(system.A.rows(), 3);
  EXPECT_NEAR(system.A(0, 0), c2 + 0.5 * s2, 1e-14);
  EXPECT_NEAR(system.A.bottomRightCorner(2, 2).trace(), 1 + s2 + 0.5 * c2, 1e-14);
  EXPECT_NEAR(system.A.row(0).tail(2).norm(), 0.5 * std::sin(tilt) * std::cos(tilt), 1e-14);
  ASSERT_EQ(rod.mode().blocks.size(), 1u);
  EXPECT_TRUE(rod.mode().blocks[0].presses && rod.mode().blocks[0].sticks);
  EXPECT_EQ(rod.mode().blocks[0].friction, 0.5);
}

TEST(ModeMotion, ABlockOnASlopeSlowsDownByItsFriction) {
  const Slope slope{0.35};
  const double mu = 0.2, steep = std::sin(slope.angle), flat = std::cos(slope.angle);
  for (const double speed : {1.5, -1.5}) {
    ModeBody block(slope.block(mu, speed));
    ASSERT_TRUE(block.start());
    EXPECT_TRUE(block.row(0).presses && block.row(0).moves && !block.row(0).sticks);
    const Vec3 a = -kG * (steep + (speed > 0 ? mu : -mu) * flat) * slope.up();
    EXPECT_LT((ModeBody::of(block.now().a, 0) - a).norm(), 1e-13);
    EXPECT_NEAR(block.now().forces.normal[0], 2 * kG * flat, 1e-13);
    block.now().a.setZero(block.now().a.size());
    ASSERT_TRUE(accelerateInMode(block.island, block.now()));  // the same in the mode that it has
    EXPECT_LT((ModeBody::of(block.now().a, 0) - a).norm(), 1e-13);
  }
}

/// A ball of 1 kg that turns about the other end of its rod.
TEST(ModeMotion, ARodTurnsAboutTheEndThatSticks) {
  const double tilt = 0.9, rate = 1.2, steep = std::sin(tilt), flat = std::cos(tilt);
  ModeBody rod(rodOnEnd(2, tilt, rate));
  ASSERT_TRUE(rod.start());
  EXPECT_TRUE(rod.row(0).sticks);
  const Vec3 along(flat, 0, steep), across(-steep, 0, flat);
  EXPECT_LT(ModeBody::of(rod.now().a, 0).norm(), 1e-13);
  const Vec3 a = -rate * rate * along - kG * flat * across;
  EXPECT_LT((ModeBody::of(rod.now().a, 1) - a).norm(), 1e-13);
  const double push = kG * steep - rate * rate;  // of the rod
  EXPECT_NEAR(rod.now().forces.normal[0], kG + push * steep, 1e-13);
  EXPECT_LT((rod.now().forces.friction[0] - push * flat * Vec3::UnitX()).norm(), 1e-13);
}

/// A ball that sinks into what gives way while it slides along it.
TEST(ModeMotion, ASpringPressesByItsLengthAndItsDamper) {
  ObstacleSpec floor = floorPlane(0.3);
  floor.contact.stiffness = 2000;
  floor.contact.damping = 10;
  Scene scene = modeScene(oneParticle(2, 0.1), Vec3(0, 0, 0.09), floor);
  scene.ragdolls[0].velocity = Vec3(0, 5, -1);
  ModeBody ball(scene);
  ball.row(0).closed = ball.row(0).presses = true;
  ASSERT_TRUE(findMode(ball.island, ball.now()));
  const double force = 2000 * 0.01 + 10 * 1;
  EXPECT_NEAR(ball.now().forces.normal[0], force, 1e-12);
  const Vec3 a(0, -0.3 * force / 2, force / 2 - kG);
  EXPECT_LT((ModeBody::of(ball.now().a, 0) - a).norm(), 1e-13);
}

TEST(ModeMotion, AnImpactReturnsTheEndAndKeepsTheRest) {
  const double tilt = 0.6, speed = 2, restitution = 0.5;
  Scene scene = rodOnEnd(0, tilt, 0);
  scene.obstacles[0].restitution = restitution;
  ModeBody rod(scene, Vec3(3, 0, -speed));
  rod.close();
  ASSERT_TRUE(takeModeImpact(rod.island, rod.now()));
  const Vec3 a = ModeBody::of(rod.now().v, 0), b = ModeBody::of(rod.now().v, 1);
  EXPECT_NEAR(a.z(), restitution * speed, 1e-13);
  const double answer = 1 - 0.5 * std::pow(std::sin(tilt), 2);
  EXPECT_LT((a + b - Vec3(6, 0, -2 * speed + (1 + restitution) * speed / answer)).norm(), 1e-13);
}

TEST(ModeMotion, ProjectionsTakeWhatIsAcrossTheModeAlone) {
  ModeBody ball(modeScene(oneParticle(1, 0.1), Vec3(0.3, 0.4, 0.1), floorPlane(0.5)));
  ball.row(0).closed = ball.row(0).presses = true;
  ball.now().x.head<3>() = Vec3(0.3, 0.4, 0.0999);
  ball.now().v.head<3>() = Vec3(1, 2, -3);
  ASSERT_TRUE(projectPositions(ball.island, ball.now()));
  ASSERT_TRUE(projectVelocities(ball.island, ball.now(), false));
  EXPECT_LT((ModeBody::of(ball.now().x, 0) - Vec3(0.3, 0.4, 0.1)).norm(), 1e-15);
  EXPECT_LT((ModeBody::of(ball.now().v, 0) - Vec3(1, 2, 0)).norm(), 1e-15);
  ball.row(0).sticks = true;
  ASSERT_TRUE(projectVelocities(ball.island, ball.now(), false));
  EXPECT_LT(ModeBody::of(ball.now().v, 0).norm(), 1e-15);
}

}  // namespace
}  // namespace ragdoll
