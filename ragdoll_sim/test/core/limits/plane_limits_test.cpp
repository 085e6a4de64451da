// Limits by regions on three planes: those of the thesis, exact gradients, the way back.
#include "ragdoll_sim/core/plane_limits.h"

#include <gtest/gtest.h>

#include "core/limits/limit_angles.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/start_state.h"
#include "support/limit_rows.h"

namespace ragdoll {
namespace {

using namespace test;

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

TEST(Planes, OfTheDirectMethodsAreTheBordersOfTheirRegions) {
  SkeletonSpec s = narrowPlanes();
  s.joints[0].planes[0] = AngleRange{rad(-5), rad(5)};
  const Model model = buildModel(sceneOf(s));
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Points x = shaken(model, 0.08, seed);
    ASSERT_EQ(model.skeletons[0].limits.size(), 6u);
    LimitAngles angles;
    double worst = 0;
    for (int k = 0; k < 6; ++k) {
      LimitRow row = limitRow(model, 0, k);
      angles.at(model, x, 0).evaluate(row, x.data());
      EXPECT_EQ(row.value, angles.at(model, x, 0)[k]);
      expectGradient(model, x, row);
      worst = std::max(worst, -row.value);
    }
    // One is an angle in the plane, the other to a border; the shaken trunk is no rigid frame.
    EXPECT_NEAR(limitViolation(model, x, 0), worst, 0.06);
  }
}

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

TEST(Planes, ViolationIsWeightedByWhatThePlaneShowsOfTheBone) {
  for (const double shown : {1.0, 0.7, 0.3, 0.05}) {  // length of the projection
    const double hidden = std::sqrt(1 - shown * shown);
    const Vec3 back = shown * Vec3(-std::cos(rad(45)), 0, -std::sin(rad(45)));  // YZ from 50
    EXPECT_NEAR(outside(1, back + hidden * Vec3(0, -1, 0)), 5 * shown, 1e-9) << shown;
  }
}

/// An arm that hangs, weightless, its shoulder's region narrow; the state's step begins with the
/// arm `by` degrees out of it, behind the body.
World armOutside(double by, int sweeps) {
  SkeletonSpec s = limbs();
  s.joints = {planes("shoulder", "trunk", "upper_arm")};
  s.joints[0].planes[1] = AngleRange{rad(88), rad(120)};
  Scene scene = sceneOf(s);
  scene.gravity.setZero();
  scene.solver.method = Method::kJakobsen;
  scene.solver.step = 1.0 / 60;
  scene.solver.sweeps = sweeps;
  World world(scene);
  const Skeleton& k = world.model.skeletons[0];
  const Vec3 shoulder = world.x(k.particle("b"));
  const Eigen::AngleAxisd turn(rad(2 + by), Vec3::UnitY());
  for (const char* name : {"elbow", "hand", "finger"}) {
    const int i = k.particle(name);
    world.state.x.col(i) = shoulder + turn * (world.x(i) - shoulder);
  }
  return world;
}

TEST(Planes, ABoneOutsideIsBackAtItsLastAllowedPositionAfterAStep) {
  // Near enough for the step guard, which opens what is far outside at 5 rad/s.
  for (const double by : {0.5, 2.0})
    for (const Vec3& last : {Vec3(0, 0, -1), Vec3(0, -0.04, -1), Vec3(0.01, 0.02, -1)}) {
      World world = armOutside(by, 200);
      const PlaneLimit& shoulder = world.model.skeletons[0].plane_limits[0];
      const auto now = [&] { return childInParent(shoulder, world.state.x.data()).normalized(); };
      ASSERT_FALSE(isAllowed(shoulder, now()));
      const Vec3 allowed = last.normalized();
      world.state.allowed.col(0) = allowed;
      world.steps(1);
      EXPECT_LT((now() - allowed).norm(), 1e-3) << by << " deg from " << last.transpose();
    }
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
