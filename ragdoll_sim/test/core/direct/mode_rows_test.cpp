#include "core/direct/mode_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/direct/mode_body.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;
using Features = std::array<int, 3>;

ObstacleSpec cube() {
  ObstacleSpec o;
  o.type = ObstacleSpec::Type::kBox;
  o.size = Vec3(2, 2, 2);
  return o;
}

ObstacleSpec sphere(double radius) {
  ObstacleSpec o;
  o.type = ObstacleSpec::Type::kSphere;
  o.radius = radius;
  return o;
}

/// A ball, or a rod of two, somewhere above an obstacle, and a row of it.
struct Above : ModeBody {
  ModeRow ball, rod;

  Above(const SkeletonSpec& skeleton, const ObstacleSpec& obstacle)
      : ModeBody(modeScene(skeleton, Vec3(0, 0, 9), obstacle)) {
    ball.obstacle = rod.obstacle = 0;
    rod.kind = ModeRow::Kind::kStick;
    rod.b = 1;
    ball.ra = ball.rb = rod.ra = rod.rb = kModeRadius;
  }
  RowPlace placeAt(const Vec3& x, const Vec3& v) {
    return placeOf(island, ball, x.data(), v.data(), true);
  }
};

TEST(ModeRows, OfABallHaveItsDistanceFromFaceEdgeAndCorner) {
  Above one(oneParticle(1, kModeRadius), cube());
  const auto expectGap = [&](const Vec3& x, double distance, const Features& feature) {
    const RowPlace place = one.placeAt(x, Vec3::Zero());
    EXPECT_NEAR(place.gap, distance - kModeRadius, 1e-15);
    EXPECT_NEAR(gapOf(one.island, one.ball, x.data()), distance - kModeRadius, 1e-15);
    EXPECT_EQ(place.feature, feature);
    EXPECT_NEAR(place.contact.normal.dot(x) - place.contact.offset, place.gap, 1e-15);
  };
  expectGap(Vec3(0.2, 0.3, 1.5), 0.5, {0, 0, 1});
  expectGap(Vec3(1.3, 0, -1.4), 0.5, {1, 0, -1});
  expectGap(Vec3(-1.2, 1.2, 1.1), 0.3, {-1, 1, 1});
}

/// A point that goes straight ahead at a speed w around what is at a distance d leaves it by w^2 /
/// d.
TEST(ModeRows, OfABallCurveByItsSpeedAround) {
  const Vec3 v(3, 4, 5);
  Above round(oneParticle(1, kModeRadius), sphere(0.5)), box(oneParticle(1, kModeRadius), cube());
  EXPECT_NEAR(round.placeAt(Vec3(0, 0, 0.8), v).curvature, (9 + 16) / 0.8, 1e-12);
  EXPECT_NEAR(box.placeAt(Vec3(0, 0, 1.5), v).curvature, 0, 1e-15);
  const Vec3 edge(1.3, 0, 1.4);  // square to it: (4, 0, -3) / 5
  EXPECT_NEAR(box.placeAt(edge, v).curvature, std::pow((4 * 3 - 3 * 5) / 5.0, 2) / 0.5, 1e-12);
  const double along = Vec3(2, 2, 1).dot(v) / 3;
  EXPECT_NEAR(box.placeAt(Vec3(1.2, 1.2, 1.1), v).curvature, (50 - along * along) / 0.3, 1e-11);
}

using Place6 = Eigen::Matrix<double, 6, 1>;

/// At random over a sphere or across an edge of a box: the gap's second derivative along the
/// motion, and how its place moves along the stick, by differences.
TEST(ModeRows, OfAStickFollowTheNearestPlace) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const ObstacleSpec& obstacle : {sphere(0.5), cube()}) {
    Above one(oneStick(), obstacle);
    for (int sample = 0; sample < 50; ++sample) {
      Place6 x, v;
      for (int k = 0; k < v.size(); ++k) v(k) = unit(random);
      const bool round = obstacle.type == ObstacleSpec::Type::kSphere;
      if (round)
        x << -0.5, -0.3, 0.8, 0.5, 0.2, 1.1;
      else  // below the face on one side of the edge, below the other face on the other
        x << 0.6, -0.3, 1.9, 1.8, 0.4, 0.6;
      x += 0.05 * v;
      const auto at = [&](double time) { return Place6(x + time * v); };
      const auto gapAt = [&](double time) { return gapOf(one.island, one.rod, at(time).data()); };
      const auto weightAt = [&](double time) {
        return placeOf(one.island, one.rod, at(time).data(), v.data(), false).contact.weight[1];
      };
      const RowPlace place = placeOf(one.island, one.rod, x.data(), v.data(), true);
      ASSERT_TRUE(place.inside && place.regular);
      const double e = 1e-3;
      const double second = (gapAt(e) - 2 * gapAt(0) + gapAt(-e)) / (e * e);
      EXPECT_NEAR(place.curvature, second, 1e-4 * (1 + std::abs(second))) << sample;
      const double moves = (weightAt(e) - weightAt(-e)) / (2 * e);
      const Vec3 turn = moves * (v.tail<3>() - v.head<3>());
      EXPECT_LT((place.turn - turn).norm(), 1e-4 * (1 + turn.norm())) << sample;
    }
  }
}

/// A rod that lies on a face, beyond an edge of it, touches at that edge. Where it turns by phi
/// about its place there, its axis goes by the edge at r cos(phi).
TEST(ModeRows, OfAStickThatLiesFlatBeyondAnEdgeAreThere) {
  Above one(oneStick(), cube());
  const double w = 3;
  for (const double side : {-1.0, 1.0}) {
    Place6 x, v;
    x << 0.5 * side, 0.2, 1 + kModeRadius, 1.5 * side, 0.2, 1 + kModeRadius;
    v << 0, 0, 0.5 * w, 0, 0, -0.5 * w;
    const RowPlace place = placeOf(one.island, one.rod, x.data(), v.data(), true);
    EXPECT_NEAR(place.at, 0.5, 1e-15);
    EXPECT_EQ(place.feature, (Features{static_cast<int>(side), 0, 1}));
    EXPECT_TRUE(place.inside && place.regular);
    EXPECT_NEAR(place.gap, 0, 1e-15);
    EXPECT_NEAR(place.curvature, -kModeRadius * w * w, 1e-12);
    EXPECT_LT((place.contact.normal - Vec3::UnitZ()).norm(), 1e-15);
    x[5] += 1e-3;  // its end beyond is raised: the other one is nearer
    EXPECT_LT(placeOf(one.island, one.rod, x.data(), v.data(), true).at, 1e-9);
  }
}

/// A head that leaves its place straight ahead, in polar coordinates about the neck's axis: with r'
/// away from the neck and w around it the angle to the axis has the second derivative -2 r' w / r.
TEST(ModeRows, OfALimitCurveAsPolarCoordinatesDo) {
  SkeletonSpec s = limbs();
  const Vec3 axis = Vec3::UnitZ();
  s.joints = {cone("neck", "trunk", "head", axis, 60)};
  ModeBody one(modeScene(s, Vec3(0, 0, 9), floorPlane()));
  const int neck = one.world.model.skeletons[0].particle("a"),
            head = one.world.model.skeletons[0].particle("head");
  ModeRow row;
  row.kind = ModeRow::Kind::kLimit;
  row.limit = 0;
  const Points x = one.body().x();
  const Vec3 bone = x.col(head) - x.col(neck), out = bone.normalized();
  const Vec3 around = (out.dot(axis) * out - axis).normalized();
  const double away = 0.7, turns = 1.3, length = bone.norm();
  Points v = Points::Zero(3, x.cols());
  v.col(head) = away * out + turns * length * around;
  const RowPlace place = placeOf(one.island, row, x.data(), v.data(), true);
  EXPECT_NEAR(place.gap, rad(60) - std::acos(out.dot(axis)), 1e-14);
  EXPECT_NEAR(place.curvature, 2 * away * turns / length, 1e-8);
}

TEST(ModeRows, HaveRoomUntilTheirPlaceEnds) {
  Above ball(oneParticle(1, kModeRadius), cube()), rod(oneStick(), cube());
  const auto room = [&](const Vec3& x, const Features& feature) {
    return roomOf(ball.island, ball.ball, x.data(), feature);
  };
  EXPECT_NEAR(room(Vec3(0.2, 0.7, 1.5), {0, 0, 1}), 0.3, 1e-15);
  EXPECT_NEAR(room(Vec3(1.1, 0.7, 1.5), {0, 0, 1}), -0.1, 1e-15);
  EXPECT_NEAR(room(Vec3(1.1, 0.7, 1.5), {1, 0, 1}), 0.1, 1e-15);
  Place6 x;  // on x + z = 2.1, nearest to the edge x = z = 1 where both are 1.05
  x << 0, 0, 2.1, 1.25, 0, 0.85;
  EXPECT_NEAR(roomOf(rod.island, rod.rod, x.data(), {1, 0, 1}), 0.05, 1e-6);
  x << 0.1, 0, 2.0, 1.07, 0, 1.03;  // that is 2 cm of 97 from the rod's end
  EXPECT_NEAR(roomOf(rod.island, rod.rod, x.data(), {1, 0, 1}), 0.02 / 0.97, 1e-6);
  // Beyond its end by as much: a time at which it was left is looked for by how far that is.
  x << 0.1, 0, 2.0, 1.03, 0, 1.07;
  EXPECT_NEAR(roomOf(rod.island, rod.rod, x.data(), {1, 0, 1}), -0.02 / 0.93, 1e-6);
}

/// A spring lets go where its damper holds it back as much as it pushes.
TEST(ModeRows, OfASpringOpenWhereItsForceEnds) {
  ObstacleSpec floor = floorPlane();
  floor.contact.stiffness = 2000;
  floor.contact.damping = 10;
  ModeBody one(modeScene(oneParticle(1, kModeRadius), Vec3(0, 0, kModeRadius), floor));
  ASSERT_EQ(one.mode().rows.size(), 1u);
  const Vec3 deep(0, 0, kModeRadius - 0.02), leaves(1, 0, 4), comes(1, 0, -4);
  EXPECT_NEAR(openingOf(one.island, one.row(0), deep.data(), leaves.data()), 0, 1e-15);
  EXPECT_NEAR(openingOf(one.island, one.row(0), deep.data(), comes.data()), -0.02, 1e-15);
}

}  // namespace
}  // namespace ragdoll
