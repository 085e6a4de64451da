#include "core/direct/mode_event_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/mode_body.h"
#include "core/direct/mode_piece.h"
#include "core/direct/mode_settle.h"
#include "support/integrate.h"

namespace ragdoll {
namespace {

using namespace test;

/// [s] of the first event in the next h of a motion; negative: there is none.
double eventOf(ModeBody& one, double h) {
  ModePoint& end = one.mode().end;
  ModeEvent found;
  EXPECT_TRUE(settleMode(one.island, false));
  EXPECT_TRUE(moveInMode(one.island, h, end, one.island.s.mode.piece) &&
              findModeEvent(one.island, h, found));
  if (!found.any) return -1;
  double time = 0;
  EXPECT_NEAR(found.share, 0.5, 0.5);
  EXPECT_TRUE(moveToModeEvent(one.island, h, found, time));
  return time;
}

TEST(ModeEventSearch, ABallLandsAfterTheRootOfTwiceItsHeight) {
  const double height = 3e-4, lands = std::sqrt(2 * height / kG);
  const Scene scene = modeScene(oneParticle(1, 0.1), Vec3(0, 0, 0.1 + height), floorPlane());
  ModeBody ball(scene), early(scene);
  EXPECT_NEAR(eventOf(ball, 1.1 * lands), lands, 1e-12);
  EXPECT_NEAR(ball.mode().end.x[2], 0.1, 1e-11);
  EXPECT_LT(eventOf(early, 0.9 * lands), 0);
}

TEST(ModeEventSearch, ASlipEndsWhenFrictionHasTakenItsSpeed) {
  const double mu = 0.4, speed = 0.02, stops = speed / (mu * kG);
  ModeBody block(Slope{0}.block(mu, speed)), early(Slope{0}.block(mu, speed));
  EXPECT_NEAR(eventOf(block, 1.3 * stops), stops, 1e-12);
  EXPECT_NEAR(block.mode().end.x[0], 0.5 * speed * stops, 1e-14);
  EXPECT_LT(eventOf(early, 0.99 * stops), 0);
}

/// It passes the edge of a box, round which it then goes.
TEST(ModeEventSearch, APlaceLeavesItsFaceAtTheEdge) {
  ObstacleSpec box;
  box.type = ObstacleSpec::Type::kBox;
  box.size = Vec3(2, 2, 2);
  box.friction = 0;
  Scene scene = modeScene(oneParticle(1, 0.1), Vec3(0.9975, 0, 1.1), box);
  scene.ragdolls[0].velocity = Vec3(0.5, 0, 0);
  ModeBody ball(scene);
  EXPECT_NEAR(eventOf(ball, 8e-3), 5e-3, 3 * kPlaceNoise / 0.5);
}

/// A ball on a smooth sphere, at the angle where it lets go (v^2 = g R cos) or `before` that [s],
/// by its pendulum's equation backwards.
Scene onSphere(double before) {
  ObstacleSpec sphere;
  sphere.type = ObstacleSpec::Type::kSphere;
  sphere.radius = 0.4;
  sphere.friction = 0;
  const double reach = 0.5, leaves = 0.8;
  const auto back = [&](const Eigen::Vector2d& s) {
    return Eigen::Vector2d(-s[1], -kG / reach * std::sin(s[0]));
  };
  const Eigen::Vector2d there(leaves, std::sqrt(kG * std::cos(leaves) / reach));
  const Eigen::Vector2d start = integrate(back, there, before);
  const Vec3 out(std::sin(start[0]), 0, std::cos(start[0]));
  Scene scene = modeScene(oneParticle(1, 0.1), reach * out, sphere);
  scene.ragdolls[0].velocity = reach * start[1] * Vec3(out.z(), 0, -out.x());
  return scene;
}

/// The force's end counts below 2e-9 of the weight: some 3e-10 s later.
TEST(ModeEventSearch, ABallLetsGoOfASphereWhereItsForceEnds) {
  const double time = 4e-3;
  ModeBody ball(onSphere(time)), early(onSphere(time));
  EXPECT_NEAR(eventOf(ball, 6e-3), time, 1e-9);
  EXPECT_LT(eventOf(early, 0.999 * time), 0);
}

/// A rod that falls over, its end stuck, from `before` [s] the angle where the force on that end
/// meets the cone of friction.
Scene fallingRod(double friction, double before) {
  const double rate = -1.5;
  const auto outside = [&](double angle) {  // of the cone
    const double push = kG * std::sin(angle) - rate * rate;
    return push * std::cos(angle) - friction * (kG + push * std::sin(angle));
  };
  double in = 1.5, out = 0.9;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (in + out);
    (outside(middle) > 0 ? out : in) = middle;
  }
  const auto back = [](const Eigen::Vector2d& s) {
    return Eigen::Vector2d(-s[1], kG * std::cos(s[0]));
  };
  const Eigen::Vector2d start = integrate(back, Eigen::Vector2d(in, rate), before);
  return rodOnEnd(friction, start[0], start[1]);
}

/// Likewise; that force turns by 3 N/s.
TEST(ModeEventSearch, ARodsEndSlipsWhereItsForceLeavesTheCone) {
  const double time = 4e-3, friction = 0.2;
  ModeBody rod(fallingRod(friction, time)), early(fallingRod(friction, time));
  EXPECT_NEAR(eventOf(rod, 7e-3), time, 2e-8);
  EXPECT_TRUE(rod.row(0).sticks);
  EXPECT_LT(eventOf(early, 0.999 * time), 0);
}

}  // namespace
}  // namespace ragdoll
