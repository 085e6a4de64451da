#include "core/direct/candidates.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/direct/contact_motion.h"
#include "core/direct/rows.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kBallRadius = 0.1;

/// A ball without weight between obstacles.
Scene ballAt(const Vec3& position, const std::vector<ObstacleSpec>& obstacles) {
  Scene scene = weightless(oneParticle(1, kBallRadius));
  scene.ragdolls[0].pose.position = position;
  scene.obstacles = obstacles;
  return scene;
}

ObstacleSpec sphere(const Vec3& centre, double radius) {
  ObstacleSpec o;
  o.type = ObstacleSpec::Type::kSphere;
  o.pose.position = centre;
  o.radius = radius;
  return o;
}

TEST(Candidates, AreWhatTheMotionComesNearTo) {
  DirectIsland one(ballAt({0, 0, 1}, {floorPlane()}));
  Body& body = one.body();
  body.motion.dx.setZero(3, 1);
  findCandidates(body, one.h);
  EXPECT_TRUE(body.constraints.contacts.empty());
  body.motion.dx.col(0) = Vec3(0.2, 0, -0.897);
  findCandidates(body, one.h);
  ASSERT_EQ(body.constraints.contacts.size(), 1U);
  EXPECT_NEAR(gapAfter(body, body.constraints.contacts[0]), 0.003, 1e-14);
}

/// A ball that goes along a large sphere: its normal hardly turns, but the plane of the end passes
/// 10 um below the start. An impact at a millionth of the step leaves no time to sink there.
TEST(Candidates, HaveThePlaneOfThePartThatAnImpactLeaves) {
  DirectIsland one(ballAt({0, 0, 5 + kBallRadius}, {sphere(Vec3::Zero(), 5)}));
  Body& body = one.body();
  body.motion.dx.setZero(3, 1);
  body.motion.dx(0, 0) = 0.01;
  findCandidates(body, one.h);
  ASSERT_EQ(body.constraints.contacts.size(), 1U);
  body.motion.dx *= 1e-6;
  EXPECT_NEAR(gapAfter(body, body.constraints.contacts[0]), -1e-5, 1e-6);
  findContactsAnew(body, 1e-6 * one.h, one.h);
  EXPECT_NEAR(gapAfter(body, body.constraints.contacts[0]), 0, 1e-12);
}

TEST(Candidates, BecomeActiveOnceViolated) {
  DirectIsland one(ballAt({0, 0, kBallRadius + 4e-3}, {floorPlane()}));
  Body& body = one.body();
  body.motion.dx.setZero(3, 1);
  findCandidates(body, one.h);
  ASSERT_EQ(body.constraints.contacts.size(), 1U);
  buildRows(body, true);  // none: it is not near enough
  EXPECT_FALSE(activateViolated(body));
  body.motion.dx(2, 0) = -6e-3;
  EXPECT_TRUE(activateViolated(body));
  EXPECT_EQ(body.constraints.role[0], Role::kActive);
}

TEST(Candidates, OfAMotionThatWasPushedSomewhereAreAdded) {
  DirectIsland one(ballAt({0, 0, 1}, {floorPlane()}));
  Body& body = one.body();
  body.motion.dx.setZero(3, 1);
  findCandidates(body, one.h);
  EXPECT_FALSE(findMissed(body, one.h));
  body.motion.dx(2, 0) = -0.95;  // 5 cm into the floor
  EXPECT_TRUE(findMissed(body, one.h));
  ASSERT_EQ(body.constraints.contacts.size(), 1U);
  EXPECT_EQ(body.constraints.role[0], Role::kActive);
}

TEST(Candidates, SqueezeABodyFromOppositeSidesOnly) {
  const ObstacleSpec left = sphere({-0.49, 0, 0}, 0.4), right = sphere({0.49, 0, 0}, 0.4),
                     below = sphere({0, 0, -0.49}, 0.4);
  const auto squeezes = [](const std::vector<ObstacleSpec>& obstacles) {
    DirectIsland one(ballAt(Vec3::Zero(), obstacles));
    one.body().motion.dx.setZero(3, 1);
    findCandidates(one.body(), one.h);
    return isSqueezed(one.body());
  };
  EXPECT_TRUE(squeezes({left, right}));
  EXPECT_FALSE(squeezes({left, below}));
  EXPECT_FALSE(squeezes({left}));
}

}  // namespace
}  // namespace ragdoll
