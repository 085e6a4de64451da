// Joint limits as geometry: exact gradients, no net force or torque, the same wherever a body is.
#include "ragdoll_sim/core/limits.h"

#include <gtest/gtest.h>

#include "core/limits/limit_angles.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/start_state.h"
#include "support/limit_rows.h"

namespace ragdoll {
namespace {

using namespace test;

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

TEST(LimitAngles, AreThoseOfThePoseThatIsAskedFor) {
  const Model model = buildModel(sceneOf(narrowPlanes()));
  LimitAngles angles;
  std::vector<Points> poses;
  for (unsigned seed = 0; seed < 6; ++seed) poses.push_back(shaken(model, 0.08, seed));
  for (const int i : {0, 1, 0, 2, 3, 4, 0, 5, 1, 0}) {  // more than are kept
    LimitAngles::Pose& pose = angles.at(model, poses[i], 0);
    LimitRow row = limitRow(model, 0, 1), expected = row;
    evaluateLimit(model, poses[i], expected);
    pose.evaluate(row, poses[i].data());
    EXPECT_EQ(pose[1], expected.value);
    ASSERT_EQ(row.count, expected.count);
    for (int k = 0; k < row.count; ++k) EXPECT_EQ(row.gradient[k], expected.gradient[k]);
    for (const int j : {0, 1, 2}) angles.at(model, poses[j], 0);
    EXPECT_EQ(angles.at(model, poses[i], 0)[1], expected.value);
  }
}

/// Values are to the bit those of one limit by itself, and what is beyond a margin is by its value.
TEST(LimitAngles, KnowWhatIsBeyondAMargin) {
  for (const SkeletonSpec& spec : {narrowPlanes(), jointedLimbs()}) {
    const Model model = buildModel(sceneOf(spec));
    const std::vector<Limit>& limits = model.skeletons[0].limits;
    for (unsigned seed = 0; seed < 200; ++seed) {
      const Points x = shaken(model, 0.002 * seed, seed);
      LimitAngles angles;
      LimitAngles::Pose& pose = angles.at(model, x, 0);
      for (int k = 0; k < static_cast<int>(limits.size()); ++k) {
        const double value = limitValue(limits[k], x.data());
        for (const double margin : {-0.1, 0.0, 0.3, 1.2, value})
          EXPECT_EQ(pose.isBeyond(k, margin), value >= margin) << k;
        EXPECT_EQ(pose[k], value) << k;
      }
    }
  }
}

}  // namespace
}  // namespace ragdoll
