// Joint limits as geometry: exact gradients, no net force or torque, known angles, no pole.
#include "ragdoll_sim/core/limits.h"

#include <gtest/gtest.h>

#include <random>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/limit_angles.h"
#include "ragdoll_sim/core/measures.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kAll = 10;  ///< [rad] a margin that lists every row

std::vector<LimitRow> rowsOf(const Model& model, const Points& x, double margin = kAll) {
  State state = startState(model);
  std::vector<LimitRow> rows;
  findLimits(model, x, state, margin, rows);
  for (LimitRow& row : rows) {
    const double value = row.value;
    evaluateLimit(model, x, row);
    EXPECT_NEAR(row.value, value, 1e-15);
  }
  return rows;
}

/// Every particle moved at random by up to `size`.
Points shaken(const Model& model, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  Points x = model.start_position;
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] += uniform(random);
  return x;
}

Quat anyTurn() { return Quat(0.4, -0.3, 0.8, 0.2).normalized(); }

TEST(LimitGradient, IsThatOfCentralDifferences) {
  const Model model = buildModel(sceneOf(jointedLimbs()));
  constexpr double kStep = 1e-6;
  int tried = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Points x = shaken(model, 0.08, seed);
    for (const LimitRow& row : rowsOf(model, x)) {
      Points exact = Points::Zero(3, model.size());
      for (int k = 0; k < row.count; ++k) exact.col(row.particle[k]) = row.gradient[k];
      for (Eigen::Index i = 0; i < x.size(); ++i) {
        Points plus = x, minus = x;
        plus.data()[i] += kStep;
        minus.data()[i] -= kStep;
        const double slope = (valueAt(model, plus, row) - valueAt(model, minus, row)) / (2 * kStep);
        ASSERT_NEAR(exact.data()[i], slope, 1e-7 * (1 + exact.norm()))
            << "joint " << row.joint << " limit " << row.limit << " coordinate " << i;
        ++tried;
      }
    }
  }
  EXPECT_GT(tried, 10000);
}

TEST(LimitGradient, HasNoNetForceAndNoNetTorque) {
  const Model model = buildModel(sceneOf(jointedLimbs()));
  for (unsigned seed = 0; seed < 100; ++seed) {
    const Points x = shaken(model, 0.2, seed);
    for (const LimitRow& row : rowsOf(model, x)) {
      Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
      double size = 0;
      for (int k = 0; k < row.count; ++k) {
        force += row.gradient[k];
        torque += Vec3(x.col(row.particle[k])).cross(row.gradient[k]);
        size += row.gradient[k].norm();
      }
      EXPECT_LT(force.norm(), 1e-12 * size);
      EXPECT_LT(torque.norm(), 1e-12 * size) << "joint " << row.joint << " limit " << row.limit;
    }
  }
}

TEST(LimitRows, AreThoseBelowTheMargin) {
  const Model model = buildModel(sceneOf(jointedLimbs()));
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Points x = shaken(model, 0.1, seed);
    for (const double margin : {0.3, 1.2}) {  // 1.2: more than some limits' whole angle
      std::size_t expected = 0;
      for (const LimitRow& row : rowsOf(model, x)) expected += row.value < margin;
      const std::vector<LimitRow> rows = rowsOf(model, x, margin);
      EXPECT_EQ(rows.size(), expected);
      for (const LimitRow& row : rows) EXPECT_LT(row.value, margin);
    }
  }
}

TEST(LimitRows, OfASleepingBodyAreNotLookedFor) {
  const Model model = buildModel(sceneOf(jointedLimbs()));
  State state = startState(model);
  state.asleep[0] = 1;
  std::vector<LimitRow> rows;
  findLimits(model, state.x, state, kAll, rows);
  EXPECT_TRUE(rows.empty());
}

TEST(LimitRows, TurnWithTheBody) {
  Scene scene = sceneOf(jointedLimbs());
  const Model model = buildModel(scene);
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Points x = shaken(model, 0.1, seed);
    const Points turned = (anyTurn().toRotationMatrix() * x).colwise() + Vec3(3, -2, 7);
    const auto here = rowsOf(model, x), there = rowsOf(model, turned);
    ASSERT_EQ(here.size(), there.size());
    for (std::size_t k = 0; k < here.size(); ++k) {
      EXPECT_NEAR(here[k].value, there[k].value, 1e-12);
      for (int i = 0; i < here[k].count; ++i)
        EXPECT_LT((anyTurn() * here[k].gradient[i] - there[k].gradient[i]).norm(), 1e-10);
    }
  }
}

/// The model with one joint, its child bone pointed along `direction` from the joint.
struct OneJoint {
  Model model;
  int from, to;

  OneJoint(const JointSpec& joint, const std::string& from_name, const std::string& to_name)
      : OneJoint(std::vector<JointSpec>{joint}, from_name, to_name) {}
  OneJoint(const std::vector<JointSpec>& joints, const std::string& from_name,
           const std::string& to_name) {
    SkeletonSpec s = limbs();
    s.joints = joints;
    model = buildModel(sceneOf(s));
    from = model.skeletons[0].particle(from_name);
    to = model.skeletons[0].particle(to_name);
  }
  Points posed(const Vec3& direction) const {
    Points x = model.start_position;
    const double length = (x.col(to) - x.col(from)).norm();
    x.col(to) = x.col(from) + length * direction.normalized();
    return x;
  }
  double violation(const Vec3& direction) const {
    return limitViolation(model, posed(direction), 0);
  }
  double least(const Vec3& direction) const {
    double least = kAll;
    for (const LimitRow& row : rowsOf(model, posed(direction))) least = std::min(least, row.value);
    return least;
  }
};

/// Bent by `angle` to the front (elbow about -y) from hanging down.
Vec3 bent(double angle_deg) { return {std::sin(rad(angle_deg)), 0, -std::cos(rad(angle_deg))}; }

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

SkeletonSpec narrowPlanes() {
  SkeletonSpec s = limbs();
  JointSpec elbow = planes("elbow", "upper_arm", "forearm");
  elbow.planes[1] = AngleRange{0, rad(10)};
  JointSpec shoulder = planes("shoulder", "trunk", "upper_arm");
  shoulder.planes[1] = AngleRange{rad(85), rad(95)};
  s.joints = {shoulder, elbow};
  return s;
}

/// Exact, and without net force or torque.
void expectGradient(const Model& model, const Points& x, const LimitRow& row) {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  for (int k = 0; k < row.count; ++k) {
    force += row.gradient[k];
    torque += Vec3(x.col(row.particle[k])).cross(row.gradient[k]);
    for (int axis = 0; axis < 3; ++axis) {
      Points plus = x, minus = x;
      plus(axis, row.particle[k]) += 1e-6;
      minus(axis, row.particle[k]) -= 1e-6;
      const double slope = (valueAt(model, plus, row) - valueAt(model, minus, row)) / 2e-6;
      EXPECT_NEAR(row.gradient[k][axis], slope, 1e-6);
    }
  }
  EXPECT_LT(force.norm(), 1e-12);
  EXPECT_LT(torque.norm(), 1e-12);
}

TEST(Planes, ReturnWithoutNetForceOrTorqueAndByTheirGradient) {
  const Model model = buildModel(sceneOf(narrowPlanes()));
  const State state = startState(model);
  int outside = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Points x = shaken(model, 0.08, seed);
    std::vector<LimitRow> rows;
    listPlanes(model, state, rows);
    ASSERT_EQ(rows.size(), 2u);
    for (LimitRow& row : rows) {
      evaluateLimit(model, x, row);
      if (row.count == 0) continue;
      EXPECT_LT(row.value, 0);
      expectGradient(model, x, row);
      ++outside;
    }
  }
  EXPECT_GT(outside, 20);
}

TEST(LimitAngles, AreThoseOfThePoseThatIsAskedFor) {
  const Model model = buildModel(sceneOf(narrowPlanes()));
  LimitAngles angles;
  std::vector<Points> poses;
  for (unsigned seed = 0; seed < 6; ++seed) poses.push_back(shaken(model, 0.08, seed));
  for (const int i : {0, 1, 0, 2, 3, 4, 0, 5, 1, 0}) {  // more than are kept
    LimitAngles::Pose& pose = angles.at(model, poses[i], 0);
    LimitRow row = limitRow(model, 0, 1), expected = row;
    evaluateLimit(model, poses[i], expected);
    pose.evaluate(model, poses[i], row);
    EXPECT_EQ(pose[1], expected.value);
    ASSERT_EQ(row.count, expected.count);
    for (int k = 0; k < row.count; ++k) EXPECT_EQ(row.gradient[k], expected.gradient[k]);
    for (const int j : {0, 1, 2}) angles.at(model, poses[j], 0);
    EXPECT_EQ(angles.at(model, poses[i], 0)[1], expected.value);
  }
}

TEST(Planes, OfTheDirectMethodsAreOneRowForEachRegion) {
  SkeletonSpec s = narrowPlanes();
  s.joints[0].planes[0] = AngleRange{rad(-5), rad(5)};
  const Model model = buildModel(sceneOf(s));
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Points x = shaken(model, 0.08, seed);
    ASSERT_EQ(model.skeletons[0].limits.size(), 3u);
    LimitAngles angles;
    double worst = 0;
    for (int k = 0; k < 3; ++k) {
      LimitRow row = limitRow(model, 0, k);
      angles.at(model, x, 0).evaluate(model, x, row);
      EXPECT_EQ(row.value, angles.at(model, x, 0)[k]);
      expectGradient(model, x, row);
      worst = std::max(worst, -row.value);
    }
    EXPECT_NEAR(limitViolation(model, x, 0), worst, 0.05);  // the shaken trunk is no rigid frame
  }
}

// --- what is refused
std::string faultOf(const SkeletonSpec& s) {
  try {
    buildModel(sceneOf(s));
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

std::string faultOf(const JointSpec& joint) {
  SkeletonSpec s = limbs();
  s.joints = {joint};
  return faultOf(s);
}

TEST(LimitChecks, NameTheJointAndWhatIsWrong) {
  const auto says = [](const JointSpec& j, const std::string& text) {
    EXPECT_NE(faultOf(j).find(text), std::string::npos) << "'" << faultOf(j) << "' lacks " << text;
    EXPECT_EQ(faultOf(j).find("joints." + j.name), 0u) << faultOf(j);
  };
  const Vec3 y = Vec3::UnitY();
  says(hinge("j", "upper_arm", "forearm", y, 20, 10), "range is 20.0 deg to 10.0 deg");
  says(hinge("j", "upper_arm", "forearm", y, -200, 10), "within (-180, 180] deg");
  says(cone("j", "trunk", "head", Vec3::UnitZ(), 0), "half angle is 0.0 deg");
  says(cone("j", "trunk", "head", Vec3::UnitZ(), 180), "it must be in (0, 180) deg");
  says(cone("j", "trunk", "palm", Vec3::UnitZ(), 40), "share no particle");
  says(hinge("j", "upper_arm", "forearm", Vec3::UnitZ(), 0, 10), "along the parent bone");
  says(cone("j", "forearm", "palm", Vec3::UnitX(), 100), "nothing shows how its parent");
  JointSpec twist = hinge("j", "upper_arm", "forearm", -y, 0, 145);
  twist.twist = rad(120);
  says(twist, "twist is 120.0 deg");
  JointSpec soft = cone("j", "trunk", "head", Vec3::UnitZ(), 60);
  soft.stiffness = -1;
  says(soft, "stiffness must be > 0");
  JointSpec region = planes("j", "trunk", "upper_arm");
  region.planes[0] = AngleRange{rad(50), rad(20)};
  says(region, "end above its begin");
}

TEST(LimitChecks, RefuseARestPoseOutsideItsLimits) {
  const std::string bend = faultOf(hinge("e", "upper_arm", "forearm", -Vec3::UnitY(), 10, 130));
  EXPECT_NE(
      bend.find("joints.e: joint 'e': the rest pose is 10.0 deg outside its limit, bent by 0.0 "
                "deg where 10.0 deg to 130.0 deg are allowed"),
      std::string::npos)
      << bend;
  const std::string tilt = faultOf(cone("n", "trunk", "head", -Vec3::UnitX(), 60));
  EXPECT_NE(tilt.find("90.0 deg off its axis where 0 to 60.0 deg are allowed"), std::string::npos)
      << tilt;
  JointSpec region = planes("p", "trunk", "upper_arm");
  region.planes[1] = AngleRange{rad(100), rad(225)};
  const std::string plane = faultOf(region);
  EXPECT_NE(plane.find("yz 90.0 deg where 100.0 deg to 225.0 deg are allowed"), std::string::npos)
      << plane;
}

TEST(LimitChecks, WarnOfARestPoseALittleOutside) {
  SkeletonSpec s = limbs();
  s.joints = {hinge("e", "upper_arm", "forearm", -Vec3::UnitY(), 0.5, 130)};
  const Model model = buildModel(sceneOf(s));
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_NE(model.warnings[0].find("joint 'e' 0.5 deg outside its limit"), std::string::npos)
      << model.warnings[0];
}

TEST(LimitChecks, WarnOfAHingeWhoseDirectionNothingShows) {
  SkeletonSpec s;
  s.particles = {particle("a", {0, 0, 0}), particle("b", {0, 0, -1}), particle("c", {0, 0, -2})};
  s.sticks = {stick("a", "b"), stick("b", "c")};
  s.segments = {bone("ab", "a", "b"), bone("bc", "b", "c")};
  s.joints = {hinge("b", "ab", "bc", Vec3::UnitY(), 0, 90)};
  const Model model = buildModel(sceneOf(s));
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_NE(model.warnings[0].find("to any side"), std::string::npos);
  EXPECT_EQ(model.skeletons[0].limits.size(), 1u);
}

// --- the thesis's planes
JointSpec thesisShoulder() {
  JointSpec j = planes("shoulder", "trunk", "upper_arm");
  j.planes = {AngleRange{0, rad(120)}, AngleRange{rad(50), rad(225)},
              AngleRange{rad(80), rad(225)}};
  return j;
}

/// In degrees, of the right arm and one plane of the thesis's shoulder.
double outside(int plane, const Vec3& direction) {
  JointSpec j = thesisShoulder();
  for (int k = 0; k < 3; ++k)
    if (k != plane) j.planes[k].reset();
  return deg(OneJoint(j, "b", "elbow").violation(direction));
}

TEST(Planes, OfTheShoulderAreTheRegionsOfTheThesis) {
  const auto at = [](const Vec3& zero, const Vec3& quarter, double angle) {
    return Vec3(std::cos(rad(angle)) * zero + std::sin(rad(angle)) * quarter);
  };
  const Vec3 ahead = Vec3::UnitX(), left = Vec3::UnitY(), up = Vec3::UnitZ();
  for (const double a : {1.0, 60.0, 119.0}) EXPECT_EQ(outside(0, at(-up, -left, a)), 0) << a;
  EXPECT_NEAR(outside(0, at(-up, -left, -10)), 10, 1e-9) << "across the body";
  EXPECT_NEAR(outside(0, at(-up, -left, 125)), 5, 1e-9) << "up at the side";
  for (const double a : {51.0, 180.0, 224.0}) EXPECT_EQ(outside(1, at(-ahead, -up, a)), 0) << a;
  EXPECT_NEAR(outside(1, at(-ahead, -up, 45)), 5, 1e-9) << "behind";
  EXPECT_NEAR(outside(1, at(-ahead, -up, 230)), 5, 1e-9) << "up in front";
  for (const double a : {81.0, 180.0, 224.0}) EXPECT_EQ(outside(2, at(left, ahead, a)), 0) << a;
  EXPECT_NEAR(outside(2, at(left, ahead, 75)), 5, 1e-9) << "across in front";
  EXPECT_NEAR(outside(2, at(left, ahead, 230)), 5, 1e-9) << "behind the side";
}

TEST(Planes, DoNotJudgeABoneSquareToThem) {
  EXPECT_EQ(outside(0, Vec3(1, 0.01, 0)), 0);
  EXPECT_EQ(outside(1, Vec3(-0.01, -1, 0)), 0);
  EXPECT_EQ(outside(2, Vec3(-0.01, 0, -1)), 0);
}

TEST(Planes, OfAnElbowStartFromStraight) {
  JointSpec elbow = planes("elbow", "upper_arm", "forearm");
  elbow.planes[1] = AngleRange{rad(0), rad(130)};
  const OneJoint arm({cone("shoulder", "trunk", "upper_arm", Vec3(0, 0, -1), 100), elbow}, "elbow",
                     "hand");
  EXPECT_LT(arm.violation(bent(129)), 1e-12);
  EXPECT_NEAR(arm.violation(bent(135)), rad(5), 1e-9);
  EXPECT_NEAR(arm.violation(bent(-5)), rad(5), 1e-9);
}

TEST(Planes, OfTheLeftArmAreMirrored) {
  for (const Vec3& d :
       {Vec3(1, -1, 0.5), Vec3(-1, -2, 0.3), Vec3(0.2, 0.5, -1), Vec3(0.4, -0.1, -1)}) {
    int allowed = 0;
    for (const bool left : {false, true}) {
      PlaneLimit limit;
      for (int k = 0; k < 3; ++k)
        limit.regions[k] = planeRegion(limitPlane(k, left, false), *thesisShoulder().planes[k]);
      const Vec3 mine(d.x(), left ? -d.y() : d.y(), d.z());
      allowed += isAllowed(limit, mine.normalized());
    }
    EXPECT_NE(allowed, 1);
  }
}

}  // namespace
}  // namespace ragdoll
