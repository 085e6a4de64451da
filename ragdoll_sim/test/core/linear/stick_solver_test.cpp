#include "core/linear/stick_solver.h"

#include <gtest/gtest.h>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// A stick along x between 1 kg and 3 kg.
struct Stick13 {
  World world{sceneOf(oneStick(1, 3))};
  const StickRows& rows = *world.model.systems[0].direct.rows;
  StickSolver sticks;

  Stick13() {
    sticks.resize(rows);
    sticks.setPose(rows, world.state.x.data());
  }
};

TEST(StickSolver, AnswersAsARigidRodDoes) {
  Stick13 s;
  Eigen::VectorXd motion(s.rows.coordinates);
  const int first = 0;
  s.sticks.answer(s.rows, &first, Vec3(1, 0, 0).eval().data(), 1, motion.data());
  EXPECT_LT((motion.head<6>() - (Eigen::VectorXd(6) << 0.25, 0, 0, 0.25, 0, 0).finished()).norm(),
            1e-15);  // both as one mass
  s.sticks.answer(s.rows, &first, Vec3(0, 1, 0).eval().data(), 1, motion.data());
  EXPECT_LT((motion.head<6>() - (Eigen::VectorXd(6) << 0, 1, 0, 0, 0, 0).finished()).norm(),
            1e-15);  // across: the first alone
  const double* mobility = s.sticks.mobility(s.rows, &first, 1);
  EXPECT_NEAR(mobility[0], 0.25, 1e-15);
  EXPECT_NEAR(mobility[s.rows.coordinates + 1], 1, 1e-15);
}

TEST(StickSolver, TakesWhatStretchesOutOfVelocities) {
  Stick13 s;
  Points v(3, 2);
  v << 1, 0, 2, 5, 0, 0;
  s.sticks.projectVelocities(s.rows, v.data());
  Points expected(3, 2);
  expected << 0.25, 0.25, 2, 5, 0, 0;  // along the stick both as their centre of mass
  EXPECT_LT((v - expected).norm(), 1e-15);
}

}  // namespace
}  // namespace ragdoll
