#include "core/direct/mode_settle.h"

#include <gtest/gtest.h>

#include "core/direct/mode_body.h"

namespace ragdoll {
namespace {

using namespace test;

/// A ball at a height over a floor, with a velocity.
struct Ball : ModeBody {
  static constexpr double kRadius = 0.1;

  Ball(double gap, const Vec3& v, const ObstacleSpec& floor)
      : ModeBody(modeScene(oneParticle(2, kRadius), Vec3(0, 0, kRadius + gap), floor), v) {}
  Vec3 velocity() { return of(now().v, 0); }
  Vec3 acceleration() { return of(now().a, 0); }
};

TEST(ModeSettle, WhatOpensOrIsAboveIsFree) {
  Ball above(1e-6, Vec3(1, 0, -3), floorPlane(0.5)), opens(0, Vec3(1, 0, 3), floorPlane(0.5));
  for (Ball* ball : {&above, &opens}) {
    ASSERT_TRUE(settleMode(ball->island, false));
    EXPECT_FALSE(ball->row(0).presses);
    EXPECT_LT((ball->acceleration() - Vec3(0, 0, -kG)).norm(), 1e-15);
    EXPECT_EQ(std::abs(ball->velocity().z()), 3);
  }
}

TEST(ModeSettle, WhatArrivesBouncesOrStays) {
  Ball bounces(0, Vec3(1, 0, -3), floorPlane(0, 0.5)), stays(0, Vec3(1, 0, -3), floorPlane());
  ASSERT_TRUE(settleMode(bounces.island, false));
  EXPECT_FALSE(bounces.row(0).presses);
  EXPECT_LT((bounces.velocity() - Vec3(1, 0, 1.5)).norm(), 1e-14);
  EXPECT_EQ(bounces.body().located, 1);
  ASSERT_TRUE(settleMode(stays.island, false));
  EXPECT_TRUE(stays.row(0).presses);
  EXPECT_LT((stays.velocity() - Vec3(1, 0, 0)).norm(), 1e-14);
  EXPECT_LT(stays.acceleration().norm(), 1e-14);
}

/// Coulomb's law of impact: friction takes no more than mu (1 + e) of the approach.
TEST(ModeSettle, AnImpactTakesAsMuchSlipAsItsFriction) {
  Ball slips(0, Vec3(4, 0, -3), floorPlane(0.4)), grips(0, Vec3(1, 0, -3), floorPlane(0.4));
  ASSERT_TRUE(settleMode(slips.island, false));
  EXPECT_NEAR(slips.velocity().x(), 4 - 0.4 * 3, 1e-14);
  EXPECT_TRUE(slips.row(0).presses && slips.row(0).moves);
  EXPECT_NEAR(slips.acceleration().x(), -0.4 * kG, 1e-14);
  ASSERT_TRUE(settleMode(grips.island, false));
  EXPECT_LT(grips.velocity().norm(), 1e-14);
  EXPECT_TRUE(grips.row(0).sticks);
}

/// What opens so slowly that it comes back before a nanometre is closed; 2e-4 m/s rise by 2e-9 m.
TEST(ModeSettle, WhatHardlyOpensStaysClosed) {
  Ball hardly(0, Vec3(0, 0, 1e-4), floorPlane()), opens(0, Vec3(0, 0, 2e-4), floorPlane());
  ASSERT_TRUE(settleMode(hardly.island, false));
  EXPECT_TRUE(hardly.row(0).presses);
  EXPECT_LT(hardly.velocity().norm(), 1e-14);
  ASSERT_TRUE(settleMode(opens.island, false));
  EXPECT_FALSE(opens.row(0).presses);
}

/// The error that a step of leapfrog leaves is taken up where it pressed, and only there.
TEST(ModeSettle, WhatPressedBeforeMayBeALittleOff) {
  const double off = 1e-8;
  Ball pressed(off, Vec3::Zero(), floorPlane(0.5)), other(off, Vec3::Zero(), floorPlane(0.5));
  const RowPlace place = placeOf(pressed.island, pressed.row(0), pressed.now().x.data(),
                                 pressed.now().v.data(), false);
  pressed.body().cache.add(keyOf(place.contact));
  ASSERT_LT(off, pressed.body().context->tolerances.touching);
  ASSERT_TRUE(settleMode(pressed.island, true));
  EXPECT_TRUE(pressed.row(0).presses);
  EXPECT_NEAR(pressed.now().x[2], Ball::kRadius, 1e-13);
  ASSERT_TRUE(settleMode(other.island, true));
  EXPECT_FALSE(other.row(0).presses);
}

}  // namespace
}  // namespace ragdoll
