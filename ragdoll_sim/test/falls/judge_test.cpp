// Labels of made-up motions whose answers are known by formula.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "ragdoll_sim/falls/judge.h"

namespace ragdoll::falls {
namespace {

constexpr double kPi = 3.14159265358979323846;

const std::vector<std::string> kNames = {"head",      "neck",     "left_shoulder", "right_shoulder",
                                         "left_hip",  "right_hip", "left_foot",     "right_foot"};

/// A stiff body of kNames that stands with its feet at 0, looks along +x.
Points stiff() {
  Points x(3, 8);
  x << 0, 0, 0, 0, 0, 0, 0, 0,  //
      0, 0, 0.2, -0.2, 0.1, -0.1, 0.1, -0.1, 1.7, 1.5, 1.45, 1.45, 0.95, 0.95, 0.06, 0.06;
  return x;
}

std::vector<Obstacle> floorPlane() {
  Obstacle floor;
  floor.type = ObstacleSpec::Type::kPlane;
  return {floor};
}

Points turned(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix() * stiff();
}

TEST(Judge, ImpactOfAPlankThatTipsOver) {
  // Tips forward at an even rate: the head is thickest and first; cos(angle) = touch / height.
  constexpr double kRate = 1.3, kRadius = 0.1, kSample = 0.01;
  std::vector<double> radii(8, 0.02);
  radii[0] = kRadius;
  Judge judge(kNames, radii, floorPlane());
  const double touch = std::acos((kRadius + 0.002) / 1.7) / kRate;
  for (int k = 0; k < 200; ++k) {
    const double angle = std::min(kPi / 2, kRate * k * kSample);
    const Points x = turned(Vec3::UnitY(), angle);
    Points v(3, 8);
    for (int i = 0; i < 8; ++i) v.col(i) = kRate * Vec3::UnitY().cross(Vec3(x.col(i)));
    judge.look(k * kSample, x, v);
  }
  const Outcome o = judge.outcome();
  ASSERT_TRUE(o.impact_time);
  EXPECT_NEAR(*o.impact_time, kSample * std::ceil(touch / kSample), 1e-9);
  EXPECT_EQ(o.impact_body, "head");
  EXPECT_EQ(o.impact_region, "head");
  EXPECT_NEAR(o.impact_speed, 1.7 * kRate, 1e-9);
  EXPECT_EQ(o.end_pose, "prone");
  EXPECT_NEAR(o.end_head_height, 0, 1e-9);
}

TEST(Judge, FeetOnTheFloorAreNoImpact) {
  Judge judge(kNames, std::vector<double>(8, 0.06), floorPlane());
  for (int k = 0; k < 10; ++k) judge.look(0.01 * k, stiff(), Points::Zero(3, 8));
  EXPECT_FALSE(judge.outcome().impact_time);
  EXPECT_EQ(judge.outcome().impact_body, "");
  EXPECT_EQ(judge.outcome().end_pose, "upright");
}

TEST(Judge, ABoxIsTouchedAtItsFace) {
  Obstacle box;
  box.type = ObstacleSpec::Type::kBox;
  box.half = Vec3(1, 1, 0.25);
  box.pose.position = Vec3(0, 0, -0.25);  // its top is at 0, beside it nothing
  for (const double beside : {0.0, 5.0}) {
    Judge judge(kNames, std::vector<double>(8, 0.1), {box});
    for (int k = 0; k <= 20; ++k) {  // the hips are first: 0.95 - 0.06 k = 0.1 + 0.002 at k = 14.1
      Points x = stiff();
      x.row(2).array() -= 0.06 * k;
      x.row(0).array() += beside;
      judge.look(k, x, Points::Zero(3, 8));
    }
    EXPECT_EQ(judge.outcome().impact_time.value_or(0), beside == 0 ? 15 : 0);
    EXPECT_EQ(judge.outcome().impact_region, beside == 0 ? "hip" : "");
  }
}

/// By angles: lean of the trunk from the vertical, then where the chest looks.
std::string poseByAngles(const Points& x) {
  const Vec3 trunk = x.col(1) - 0.5 * (x.col(4) + x.col(5)), across = x.col(2) - x.col(3);
  const double lean = std::atan2(trunk.head<2>().norm(), trunk.z());
  if (lean < std::acos(0.7)) return "upright";
  const Vec3 chest = across.cross(trunk);  // along +x as it stands
  const double up = std::atan2(chest.z(), chest.head<2>().norm());
  if (up > std::asin(0.6)) return "supine";
  if (up < -std::asin(0.6)) return "prone";
  return across.z() > 0 ? "on_right_side" : "on_left_side";
}

TEST(PoseClass, IsHowTheBodyLiesAtAllTurns) {
  std::map<std::string, int> seen;
  for (int lean = 0; lean <= 180; lean += 9)
    for (int roll = 0; roll < 360; roll += 7)
      for (int yaw = 0; yaw < 360; yaw += 31) {
        const Points x = (Eigen::AngleAxisd(yaw * kPi / 180, Vec3::UnitZ()) *
                          Eigen::AngleAxisd(lean * kPi / 180, Vec3::UnitY()) *
                          Eigen::AngleAxisd(roll * kPi / 180, Vec3::UnitZ()))
                             .toRotationMatrix() *
                         stiff();
        const std::string pose = poseClass(x.col(1), x.col(2), x.col(3), x.col(4), x.col(5));
        EXPECT_EQ(pose, poseByAngles(x)) << lean << " " << roll << " " << yaw;
        ++seen[pose];
      }
  EXPECT_EQ(seen.size(), 5u);
}

TEST(PoseClass, OfTheFourWaysToLie) {
  const auto pose = [](const Points& x) {
    return poseClass(x.col(1), x.col(2), x.col(3), x.col(4), x.col(5));
  };
  EXPECT_EQ(pose(turned(Vec3::UnitY(), kPi / 2)), "prone");
  EXPECT_EQ(pose(turned(Vec3::UnitY(), -kPi / 2)), "supine");
  EXPECT_EQ(pose(turned(Vec3::UnitX(), kPi / 2)), "on_right_side");
  EXPECT_EQ(pose(turned(Vec3::UnitX(), -kPi / 2)), "on_left_side");
}

TEST(RegionOf, HasNoSide) {
  EXPECT_EQ(regionOf("left_knee"), "knee");
  EXPECT_EQ(regionOf("right_hand"), "hand");
  EXPECT_EQ(regionOf("left_leg"), "hip");
  EXPECT_EQ(regionOf("neck"), "head");
  EXPECT_EQ(regionOf("head"), "head");
}

}  // namespace
}  // namespace ragdoll::falls
