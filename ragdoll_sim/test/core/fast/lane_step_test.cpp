#include "core/fast/lane_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <set>

#include "core/fast/dispatch.h"
#include "core/fast/lane_bodies.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

using namespace test;

/// All that this processor has of one kind of numbers.
std::set<const fast::PackMethod*> methods(bool single_precision) {
  std::set<const fast::PackMethod*> all;
  for (const int most : {1, 2, 4, 8, 16}) all.insert(&fast::packFor(single_precision, 1000, most));
  return all;
}

/// Bodies of a pack that start with velocities of their own.
struct Pack : LaneBodies {
  Pack(const Scene& scene, int count) : LaneBodies(scene, count) {
    for (int l = 0; l < count; ++l) bodies[l].v.colwise() += Vec3(l, -2 * l, 0.5 * l);
  }
};

TEST(LaneStep, EveryPackFallsByTheParabola) {
  for (const bool single_precision : {false, true}) {
    const double rounding = single_precision ? 3e-6 : 3e-14;
    for (const fast::PackMethod* method : methods(single_precision)) {
      Pack pack(sceneOf(chainOfThree(), Vec3(0, 0, 5)), method->lanes);
      pack.take(*method);
      const double h = pack.step.h;
      const Vec3 g(0, 0, -9.81);
      for (int l = 0; l < method->lanes; ++l) {
        const LaneBodies::One& one = pack.bodies[l];
        ASSERT_TRUE(pack.lanes[l].good);
        const Points x1 = (one.x + h * one.v).colwise() + 0.5 * h * h * g;
        EXPECT_LT((one.x1 - x1).norm(), rounding) << method->lanes << " lanes";
        EXPECT_LT((one.predicted - x1).norm(), rounding);
        EXPECT_LT((one.v1 - (one.v.colwise() + h * g)).norm(), rounding / h);
      }
    }
  }
}

/// What the first round of a second step has to change, of a human without limits that tumbles.
double restOfTheGuess(double h) {
  Scene scene = parseScene("ragdolls: [{model: human, angular_velocity: [2, -1, 1.5]}]\n", "test");
  auto free = std::make_shared<SkeletonSpec>(*scene.ragdolls[0].skeleton);
  free->joints.clear();
  scene.ragdolls[0].skeleton = free;
  scene.solver.step = h;
  LaneBodies human(scene);
  human.take(fast::packFor(false, 1, 1));
  human.bodies[0].x = human.bodies[0].x1;
  human.bodies[0].v = human.bodies[0].v1;
  OneLane& w = human.predicted();
  fast::setRest(human.body, w);
  double most = 0;
  for (int k = 0; k < human.body.tree.size; ++k) most = std::max(most, std::abs(w.y[k]));
  return most;
}

TEST(LaneStep, GuessesTheFreeMotionToThirdOrder) {
  EXPECT_NEAR(std::log2(restOfTheGuess(1.0 / 120) / restOfTheGuess(1.0 / 240)), 3, 0.2);
}

TEST(LaneStep, ABallAtRestPressesWithItsWeight) {
  LaneBodies ball(ballOver(0, 3, Vec3::Zero(), floorPlane(0.5)));
  for (int n = 0; n < 2; ++n) {  // the second starts at the first one's impulses
    ball.take(fast::packFor(false, 1, 1));
    ASSERT_TRUE(ball.lanes[0].good);
    EXPECT_LT((ball.bodies[0].x1 - ball.bodies[0].x).norm(), 1e-15);
    EXPECT_LT(ball.bodies[0].v1.norm(), 1e-13);
    ASSERT_EQ(ball.lanes[0].impulse_count, 1);
    EXPECT_NEAR(ball.bodies[0].impulses[0].impulse[2], 3 * 9.81, 1e-10);
  }
}

TEST(LaneStep, WhatNewtonCannotReachIsNotGood) {
  Scene stretched = weightless(oneStick()), turns = stretched, fits = stretched;
  stretched.ragdolls[0].place = {{"b", Vec3(1.01, 0, 0)}};
  const double h = SolverSpec().step, most = 2 * std::sqrt(fast::kMostSine2) / h;
  turns.ragdolls[0].angular_velocity = Vec3(0, 0, 1.5 * most);
  fits.ragdolls[0].angular_velocity = Vec3(0, 0, 0.3 * most);
  for (const auto& [scene, good] : {std::pair(stretched, false), {turns, false}, {fits, true}}) {
    LaneBodies rod(scene);
    rod.take(fast::packFor(false, 1, 1));
    EXPECT_EQ(rod.lanes[0].good, good);
  }
}

/// A neighbour that is lost, or high above the floor, changes no bit.
TEST(LaneStep, LanesDoNotKnowOfEachOther) {
  for (const fast::PackMethod* method : methods(false)) {
    const int last = method->lanes - 1;
    Scene scene = tiltedRod(0.3);
    scene.ragdolls[0].velocity = Vec3(0, 1, -1);
    Pack alone(scene, method->lanes), beside(scene, method->lanes);
    for (int l = 0; l < last; ++l) {
      beside.bodies[l].v.col(1).setConstant(l % 2 ? std::nan("") : 1e3);
      alone.bodies[l].x.row(2).array() += 100;
    }
    alone.take(*method);
    beside.take(*method);
    ASSERT_TRUE(alone.lanes[last].good && beside.lanes[last].good);
    EXPECT_EQ(alone.bodies[last].x1, beside.bodies[last].x1) << method->lanes;
    EXPECT_EQ(alone.bodies[last].v1, beside.bodies[last].v1) << method->lanes;
    EXPECT_EQ(last > 0 && beside.lanes[0].good, false);
  }
}

/// A chain with random velocities, of which damping leaves none within it.
TEST(LaneStep, DampingInsideLeavesTheRigidMotionWithTheSameMomenta) {
  LaneBodies one(weightless(chainOfThree()));
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  Points& x = one.bodies[0].x;
  x.col(2) = x.col(1) + Vec3(0, 0.6, 0.8);
  Points& v = one.bodies[0].v;
  for (int i = 0; i < v.size(); ++i) v.data()[i] = normal(random);
  OneLane& w = one.predicted();
  EXPECT_NEAR(fast::energyOf<OneLane>(one.body, w.v, 1), 0.5 * one.bodies[0].v.squaredNorm(),
              1e-14);
  fast::dampInside(one.body, 0, w);
  const Points before = one.bodies[0].v, after = Eigen::Map<Points>(w.v, 3, 3);
  EXPECT_LT((after - before).rowwise().sum().norm(), 1e-14);
  Vec3 spin = Vec3::Zero();
  for (int i = 0; i < 3; ++i) spin += x.col(i).cross(after.col(i) - before.col(i));
  EXPECT_LT(spin.norm(), 1e-8);  // kept to 1e-9 of the inertia
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j)
      EXPECT_NEAR((x.col(i) - x.col(j)).dot(after.col(i) - after.col(j)), 0, 1e-14);
}

}  // namespace
}  // namespace ragdoll
