#include "core/direct/mode_slow_slips.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/mode_body.h"
#include "core/direct/mode_piece.h"
#include "core/direct/mode_settle.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kAngle = 0.5, kPiece = 1e-3;  ///< [rad], [s]

/// A ball that slides on a slope at the angle of friction: nothing speeds it up down the line of
/// fall, and friction turns it there within speed / 4.7 m/s^2.
struct Creeper : ModeBody {
  static Scene scene() {
    Scene scene = modeScene(oneParticle(2, kModeRadius), Vec3(0, 0, kModeRadius),
                            floorPlane(std::tan(kAngle)));
    scene.gravity = kG * Vec3(std::sin(kAngle), 0, -std::cos(kAngle));
    return scene;
  }
  /// aside: [rad] from the line of fall.
  Creeper(double speed, double aside)
      : ModeBody(scene(), speed * Vec3(std::cos(aside), std::sin(aside), 0)) {
    EXPECT_TRUE(settleMode(island, false));
  }
  double lasts = 0;
  bool isSlow() {
    EXPECT_TRUE(findSlowSlips(island, kPiece, 0, lasts));
    EXPECT_EQ(mode().slow.rows.size(), row(0).slow ? 1u : 0u);
    return row(0).slow;
  }
};

TEST(SlowSlips, AreThoseThatFrictionTurnsWithinAPiece) {
  EXPECT_TRUE(Creeper(1e-6, 0).isSlow());
  EXPECT_FALSE(Creeper(1e-2, 0).isSlow());
}

TEST(SlowSlips, AreOnTheirWayAlready) {
  EXPECT_TRUE(Creeper(1e-6, 1e-5).isSlow());   // 1e-11 m/s
  EXPECT_FALSE(Creeper(1e-6, 1e-3).isSlow());  // 1e-9 m/s
}

TEST(SlowSlips, AreLeftAloneWhereNothingRubs) {
  ModeBody ball(modeScene(oneParticle(2, kModeRadius), Vec3(0, 0, kModeRadius), floorPlane(0)),
                Vec3(1e-6, 0, 0));
  ASSERT_TRUE(settleMode(ball.island, false));
  double lasts = 0;
  EXPECT_TRUE(findSlowSlips(ball.island, kPiece, 0, lasts));
  EXPECT_EQ(lasts, INFINITY);
  EXPECT_TRUE(ball.mode().slow.rows.empty());
}

/// An explicit piece of 5000 times the time in which friction turns it, with a velocity across that
/// would be thrown from side to side.
TEST(SlowSlips, GoOnInAPieceAsTheyWould) {
  Creeper ball(1e-6, 1e-5);
  ASSERT_TRUE(ball.isSlow());
  ASSERT_TRUE(moveInMode(ball.island, kPiece, ball.mode().end, ball.mode().piece));
  const Vec3 v = ModeBody::of(ball.mode().end.v, 0);
  EXPECT_NEAR(v.x(), 1e-6, 1e-14);
  EXPECT_LT(std::abs(v.y()), 1.1e-11);
}

TEST(SlowSlips, AreNoneOnceTheyAreCleared) {
  Creeper ball(1e-6, 0);
  ASSERT_TRUE(ball.isSlow());
  clearSlowSlips(ball.mode());
  EXPECT_FALSE(ball.row(0).slow);
  EXPECT_TRUE(ball.mode().slow.rows.empty());
}

}  // namespace
}  // namespace ragdoll
