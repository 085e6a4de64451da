// Cones and hinges: known angles, no pole and no jump where a limb is straight.
#include <gtest/gtest.h>

#include "ragdoll_sim/core/build_model.h"
#include "support/limit_rows.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Cone, LeavesHalfAngleMinusTheAngleOffItsAxis) {
  const OneJoint neck(cone("neck", "trunk", "head", Vec3::UnitZ(), 40), "a", "head");
  for (const double angle : {35.0, 39.0, 41.0, 90.0, 179.0}) {
    for (const double around : {0.0, 70.0, 250.0}) {
      const Vec3 d(std::sin(rad(angle)) * std::cos(rad(around)),
                   std::sin(rad(angle)) * std::sin(rad(around)), std::cos(rad(angle)));
      EXPECT_NEAR(neck.least(d), rad(40 - angle), 1e-12);
      EXPECT_NEAR(neck.violation(d), std::max(0.0, rad(angle - 40)), 1e-12);
    }
  }
}

const std::vector<JointSpec>& elbow() {
  static const std::vector<JointSpec> joints = {
      cone("shoulder", "trunk", "upper_arm", Vec3(0.6, -0.6, -0.5), 100),
      hinge("elbow", "upper_arm", "forearm", -Vec3::UnitY(), 0, 145)};
  return joints;
}

TEST(Hinge, AllowsItsRangeAndForbidsTheRest) {
  const OneJoint arm(elbow(), "elbow", "hand");
  for (const double angle : {0.0, 1.0, 30.0, 90.0, 144.9})
    EXPECT_LT(arm.violation(bent(angle)), 1e-12);
  EXPECT_NEAR(arm.violation(bent(150)), rad(5), 1e-12);
  for (const double angle : {0.01, 1.0, 20.0, 60.0}) {
    EXPECT_NEAR(arm.violation(bent(-angle)), rad(angle), 1e-12);
  }
}

TEST(Hinge, HasNoJumpWhereTheArmIsStraight) {
  const OneJoint arm(elbow(), "elbow", "hand");
  for (const double around : {0.0, 30.0, 90.0, 140.0, 180.0}) {  // through straight, any direction
    double before = 0;
    for (int i = -2000; i <= 2000; ++i) {
      const double angle = rad(0.01 * i);
      const Vec3 d(std::sin(angle) * std::cos(rad(around)), std::sin(angle) * std::sin(rad(around)),
                   -std::cos(angle));
      const double value = arm.least(d);
      if (i > -2000) {
        EXPECT_LT(std::abs(value - before), 1.01 * rad(0.01)) << i << " " << around;
      }
      before = value;
    }
  }
}

TEST(Hinge, KeepsItsGradientWhereTheArmIsStraight) {
  const OneJoint arm(elbow(), "elbow", "hand");
  const auto pull = [&](double angle_deg) {  // on the hand, of the row against bending back
    for (const LimitRow& row : rowsOf(arm.model, arm.posed(bent(angle_deg)), rad(30)))
      if (row.joint == 1)
        for (int k = 0; k < row.count; ++k)
          if (row.particle[k] == arm.to) return row.gradient[k];
    return Vec3(Vec3::Zero());
  };
  for (const double angle : {-5.0, -0.1, -1e-6, 0.0, 1e-6, 0.1, 5.0}) {
    EXPECT_NEAR(pull(angle).norm(), 1 / 0.25, 1e-9);  // 1 / length of the forearm
    EXPECT_GT(pull(angle).x(), 3.9) << "to the front";
  }
}

TEST(Hinge, TurnsWithTheUpperArm) {
  // The shoulder swings the arm from its axis; the forearm's forward direction goes along. Known
  // where the swing is a turn in one plane: from straight ahead and down to the side of the axis.
  SkeletonSpec s = limbs();
  s.joints = {cone("shoulder", "trunk", "upper_arm", Vec3(1, 0, -1), 100),
              hinge("elbow", "upper_arm", "forearm", -Vec3::UnitY(), 0, 145)};
  const Model model = buildModel(sceneOf(s));
  const int shoulder = model.skeletons[0].particle("b");
  const int elbow = model.skeletons[0].particle("elbow"),
            hand = model.skeletons[0].particle("hand");
  for (const double lift : {-40.0, 0.0, 60.0, 120.0}) {
    for (const double bend : {-10.0, 30.0, 150.0}) {
      Points x = model.start_position;
      x.col(elbow) = x.col(shoulder) + 0.3 * bent(lift);
      x.col(hand) = x.col(elbow) + 0.25 * bent(lift + bend);
      const double outside = bend < 0 ? -bend : std::max(0.0, bend - 145);
      EXPECT_NEAR(limitViolation(model, x, 0), rad(outside), 1e-12) << lift << " " << bend;
    }
  }
}

TEST(Hinge, ThatMayBendBackAFewDegreesDoesSo) {
  std::vector<JointSpec> joints = elbow();
  joints[1].range = {rad(-10), rad(145)};
  const OneJoint arm(joints, "elbow", "hand");
  for (const double angle : {-10.0, -5.0, 0.0, 20.0}) EXPECT_LT(arm.violation(bent(angle)), 1e-12);
  EXPECT_NEAR(arm.violation(bent(-13)), rad(3), 1e-12);
}

TEST(Hinge, WrittenWithTheOppositeAxisIsTheSame) {
  std::vector<JointSpec> joints = elbow();
  joints[1].axis = Vec3::UnitY();
  joints[1].range = {rad(-145), 0};
  const OneJoint mirrored(joints, "elbow", "hand"), arm(elbow(), "elbow", "hand");
  for (double angle = -80; angle < 180; angle += 7)
    EXPECT_NEAR(mirrored.violation(bent(angle)), arm.violation(bent(angle)), 1e-12) << angle;
}

TEST(Hinge, WithATwistRangeKeepsItsPlaneNearer) {
  std::vector<JointSpec> joints = elbow();
  joints[1].twist = rad(30);
  const OneJoint arm(joints, "elbow", "hand");
  const auto aside = [](double bend, double around) {  // the plane of bending turned about the arm
    return Vec3(std::sin(rad(bend)) * std::cos(rad(around)),
                std::sin(rad(bend)) * std::sin(rad(around)), -std::cos(rad(bend)));
  };
  for (const double around : {-29.0, 0.0, 29.0}) EXPECT_LT(arm.violation(aside(60, around)), 1e-12);
  for (const double around : {-40.0, 40.0})  // sin of the angle to the plane at 30 degrees
    EXPECT_NEAR(std::sin(arm.violation(aside(60, around))), std::sin(rad(60)) * std::sin(rad(10)),
                1e-12);
}

TEST(Hinge, OnARigidParentMeasuresFromTheRestPose) {
  const OneJoint head(hinge("neck", "trunk", "head", Vec3::UnitY(), -30, 50), "a", "head");
  const auto nod = [](double angle) {  // forward about +y from up
    const Vec3 rest = Vec3(0, -0.2, 0.3).normalized();
    return Vec3(Eigen::AngleAxisd(rad(angle), Vec3::UnitY()) * rest);
  };
  for (const double angle : {-29.0, 0.0, 49.0}) EXPECT_LT(head.violation(nod(angle)), 1e-12);
  const double r = 0.3 / std::hypot(0.2, 0.3);  // distance from the axis
  EXPECT_NEAR(head.violation(nod(55)), rad(5) * r, 1e-12);
  EXPECT_NEAR(head.violation(nod(-40)), rad(10) * r, 1e-12);
  for (const double lean : {-20.0, 20.0}) {  // out of its plane, to either side
    const Vec3 aside =
        Eigen::AngleAxisd(rad(lean), Vec3::UnitX()) * Vec3(0, -0.2, 0.3).normalized();
    EXPECT_NEAR(head.violation(aside), rad(15), 1e-12) << "5 degrees of play";
  }
}

TEST(Hinge, OfTwoGroupsFollowsTheirTurn) {
  const OneJoint waist(hinge("waist", "trunk", "pelvis", -Vec3::UnitY(), -20, 60), "c", "e");
  const Skeleton& s = waist.model.skeletons[0];
  const Vec3 hinge_point = s.rest.col(s.particle("c"));
  const Vec3 axis = (s.rest.col(s.particle("d")) - s.rest.col(s.particle("c"))).normalized();
  for (const double angle : {-30.0, -19.0, 0.0, 59.0, 70.0}) {
    Points x = waist.model.start_position;
    for (const char* name : {"e", "f"}) {
      const int i = s.particle(name);
      x.col(i) = hinge_point + Eigen::AngleAxisd(rad(angle), axis) * (x.col(i) - hinge_point);
    }
    const double outside = std::max({0.0, angle - 60, -20 - angle});
    EXPECT_NEAR(deg(limitViolation(waist.model, x, 0)), outside, 0.3) << angle;
  }
}

}  // namespace
}  // namespace ragdoll
