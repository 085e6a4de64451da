#include "core/fast/lane_contacts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/fast/lane_bodies.h"
#include "core/linear/tree_solver.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;
using Row = fast::ContactRow<double>;

/// An end of a rod of two balls answers along the rod as both, across it as its own ball.
TEST(LaneContacts, AnEndOfARodAnswersByItsTilt) {
  const double tilt = 0.6, s2 = std::pow(std::sin(tilt), 2);
  LaneBodies rod(tiltedRod(tilt));
  OneLane& w = rod.rows();
  ASSERT_EQ(w.contact_count, 1);
  EXPECT_NEAR(1 / w.contacts[0].inverse_normal, 1 - 0.5 * s2, 1e-14);
  EXPECT_NEAR(1 / w.contacts[0].inverse_tangent, 1, 1e-14);  // the larger one: across the rod
}

/// At a place between its balls a rod answers square to it by the squares of their shares.
TEST(LaneContacts, APlaceOnARodAnswersByItsShares) {
  LaneBodies rod(sceneOf(oneStick()));
  fast::LaneContact contact;
  contact.feature = rod.body.particles;
  contact.weight = 0.3;
  contact.radius = 0.25;
  rod.lanes[0].contacts = &contact;
  rod.lanes[0].contact_count = 1;
  OneLane& w = rod.rows();
  ASSERT_EQ(w.contact_count, 1);
  const Row& row = w.contacts[0];
  EXPECT_NEAR(1 / row.inverse_normal, 0.7 * 0.7 + 0.3 * 0.3, 1e-14);
  EXPECT_NEAR(row.start, -0.25, 1e-15);
  w.dx[2] = 0.1;
  w.dx[5] = -0.2;
  EXPECT_NEAR(fast::atFeature(*row.feature, row.weight, w.dx).z, 0.7 * 0.1 - 0.3 * 0.2, 1e-15);
}

/// On rods, sides of groups and lines about which they fold: as all coordinates solved for at once.
TEST(LaneContacts, APlaceOnAnyStickAnswersAsTheWholeTreeDoes) {
  LaneBodies one(sceneOf(limbs()));
  TreeSolver solver;
  solver.resize(one.body.tree);
  solver.setPose(one.bodies[0].x.data());
  Points moved(3, one.body.tree.particles);
  fast::LaneContact contact;
  contact.weight = 0.3;
  contact.offset = 10;  // all of it is below
  one.lanes[0].contacts = &contact;
  one.lanes[0].contact_count = 1;
  const int features = static_cast<int>(one.body.features.size());
  ASSERT_GT(features, one.body.particles + 10);
  for (contact.feature = one.body.particles; contact.feature < features; ++contact.feature) {
    const OneLane& w = one.rows();
    ASSERT_EQ(w.contact_count, 1);
    const fast::Feature& f = one.body.features[contact.feature];
    const int ends[] = {f.a, f.b};
    const double force[] = {0, 0, 0.7, 0, 0, 0.3};
    solver.answer(ends, force, 2, moved.data());
    const double answer = 0.7 * moved(2, f.a) + 0.3 * moved(2, f.b);
    EXPECT_NEAR(1 / w.contacts[0].inverse_normal, answer, 1e-12) << contact.feature;
  }
}

/// kNear and kReach times the way of the step.
TEST(LaneContacts, AreOfWhatIsNear) {
  const double h = SolverSpec().step, near = fast::kNear + fast::kReach * 3 * h;
  const auto count = [](double gap, const Vec3& v) {
    Scene scene = ballOver(gap, 1, v, floorPlane());
    scene.gravity.setZero();
    return LaneBodies(scene).rows().contact_count;
  };
  EXPECT_EQ(count(0.999 * near, Vec3(3, 0, 0)), 1);
  EXPECT_EQ(count(1.001 * near, Vec3(3, 0, 0)), 0);
  EXPECT_EQ(count(1.001 * near, Vec3(0, 0, -3)), 1);  // the motion leads there
}

/// What is near takes part once a round has brought it as near as kWake.
TEST(LaneContacts, WaitUntilTheyAreNear) {
  static_assert(fast::kWake < 0.008 && 0.008 < fast::kNear, "a contact that waits");
  for (const double beyond : {fast::kWake, 1e-4, -1e-4}) {
    Scene scene = ballOver(0.008, 1, Vec3::Zero(), floorPlane());
    scene.gravity.setZero();
    LaneBodies ball(scene);
    OneLane& w = ball.rows();
    ASSERT_EQ(w.contact_count, 1);
    EXPECT_EQ(w.awake_count, 0);
    EXPECT_EQ(w.contacts[0].inverse_normal, 0);
    w.dx[2] = beyond - 0.008;
    EXPECT_EQ(fast::measureContacts(ball.body, w), beyond < 0);
    EXPECT_EQ(w.awake_count, beyond < fast::kWake ? 1 : 0);
    EXPECT_EQ(w.contacts[0].inverse_normal, beyond < fast::kWake ? 1 : 0);  // 1 kg
  }
}

/// [N] -> [kg m]: h^2 / 2 times, split along the normal and along the floor. A fifth of what is
/// violated is undone.
TEST(LaneContacts, BeginAtTheLastStepsImpulses) {
  LaneBodies ball(ballOver(-0.01, 1, Vec3::Zero(), floorPlane(0.5)));
  ball.bodies[0].impulses[0].impulse[0] = 3;
  ball.bodies[0].impulses[0].impulse[2] = 20;
  ball.lanes[0].impulse_count = 1;
  const Row& row = ball.rows().contacts[0];
  const double share = 0.5 * ball.step.h * ball.step.h;
  EXPECT_NEAR(row.press, share * 20, 1e-16);
  EXPECT_NEAR(row.pull[0] * row.axes[1].x + row.pull[1] * row.axes[2].x, share * 3, 1e-16);
  EXPECT_NEAR(row.pull[0] * row.axes[1].y + row.pull[1] * row.axes[2].y, 0, 1e-16);
  EXPECT_NEAR(row.allowed, -(1 - fast::kRecovery) * 0.01, 1e-15);
}

/// A ball that the free motion brings below the floor is put back onto it, and friction takes of
/// its way along the floor what it can.
TEST(LaneContacts, ASweepPressesTheGapOutAndRubsWithinTheCone) {
  const double mass = 2, mu = 0.5, deep = 0.02;
  for (const double along : {0.03, 0.004}) {
    LaneBodies ball(ballOver(0, mass, Vec3::Zero(), floorPlane(mu)));
    OneLane& w = ball.rows();
    ASSERT_EQ(w.contact_count, 1);
    w.dx[0] = along;
    w.dx[2] = -deep;
    fast::measureContacts(ball.body, w);
    fast::sweepContacts(w);
    const Row& row = w.contacts[0];
    const double rubs = std::min(mu * deep, along);
    EXPECT_NEAR(row.press, mass * deep, 1e-15);
    EXPECT_NEAR(row.pull[0], -mass * rubs, 1e-15);  // the floor's first tangent is x
    double moved[] = {row.gap, row.slip[0], row.slip[1]};
    fast::addAlong<3>(w, row.feature->row, row.z, moved);
    EXPECT_NEAR(moved[0], 0, 1e-16);
    EXPECT_NEAR(moved[1], along - rubs, 1e-16);
  }
}

TEST(LaneContacts, NeverPull) {
  LaneBodies ball(ballOver(0, 1, Vec3::Zero(), floorPlane(0.5)));
  OneLane& w = ball.rows();
  w.contacts[0].press = 0.003;  // of the last step
  w.contacts[0].pull[0] = 0.001;
  fast::push(w, w.contacts[0], w.contacts[0].press, w.contacts[0].pull);
  w.dx[2] = 0.1;
  fast::measureContacts(ball.body, w);
  fast::sweepContacts(w);
  EXPECT_EQ(w.contacts[0].press, 0);
  EXPECT_EQ(w.contacts[0].pull[0], 0);
  double moved[] = {0, 0, 0};
  fast::addAlong<3>(w, w.contacts[0].feature->row, w.contacts[0].z, moved);
  EXPECT_NEAR(moved[0], 0, 1e-18);
}

/// A point whose slip alone would press it, as its links turn it: in the second lane.
TEST(LaneContacts, WhatDoesNotPressTakesNoGripWhoeverSharesItsPack) {
  using Pair = fast::Pack<double, 2>;
  fast::ContactRow<Pair> row{};
  fast::Answer<Pair> answer;
  const Pair one = Pair{} + 1.0;
  answer.own = answer.first = answer.second = one;
  answer.couple[0] = 0.5 * one;
  fast::setAnswer(answer, row);
  row.inverse_normal = row.inverse_tangent = one;
  row.friction = 4.0 * one;
  Pair moved[3] = {Pair{}, Pair{} - 0.01 * one, Pair{}}, change[3];
  fast::setLane(moved[0], 0, -0.02);
  fast::setLane(moved[0], 1, 0.001);
  fast::setLane(moved[1], 1, 0.03);
  Pair press{}, pull[2]{}, most{};
  const auto all = fast::less(Pair{}, one);
  ASSERT_TRUE(fast::solveRow(row, moved, all, Pair{}, press, pull, change, most));
  EXPECT_GT(fast::lane(press, 0), 0);
  EXPECT_EQ(fast::lane(press, 1), 0);
  EXPECT_EQ(fast::lane(pull[0], 1), 0);
}

/// One sweep stops a point that friction holds, however its answers depend on each other.
TEST(LaneContacts, AGripStopsItsPointAtOnce) {
  Row row{};
  fast::Answer<double> answer;
  answer.own = 1;
  answer.first = 2;
  answer.second = 1.5;
  answer.mixed = 0.4;
  answer.couple[0] = -0.9;
  answer.couple[1] = 0.6;
  fast::setAnswer(answer, row);
  row.inverse_normal = 1 / row.answer_normal;
  row.inverse_tangent = 1 / row.answer_tangent;
  row.friction = 2;
  const double moved[3] = {-0.03, 0.01, -0.02};
  double press = 0, pull[2] = {0, 0}, change[3], most = 0;
  ASSERT_TRUE(fast::solveRow(row, moved, true, 0.0, press, pull, change, most));
  EXPECT_NEAR(moved[0] + press - 0.9 * pull[0] + 0.6 * pull[1], 0, 1e-16);
  EXPECT_NEAR(moved[1] - 0.9 * press + 2 * pull[0] + 0.4 * pull[1], 0, 1e-16);
  EXPECT_NEAR(moved[2] + 0.6 * press + 0.4 * pull[0] + 1.5 * pull[1], 0, 1e-16);
}

}  // namespace
}  // namespace ragdoll
