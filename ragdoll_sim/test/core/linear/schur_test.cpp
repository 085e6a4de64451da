// Contacts that all but contradict each other: what sweeps of Gauss-Seidel alone do not find.
#include "core/linear/schur.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "core/linear/pinched.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Schur, FindsWhatPinchesAStick) {
  Pinched pinched(0.02, 0);
  const Eigen::Vector2d b(-1e-4, -1e-4);
  Eigen::VectorXd p = Eigen::VectorXd::Zero(2);
  const Eigen::Vector2d exact = -Eigen::Matrix2d(pinched.schur.matrix()).inverse() * b;
  EXPECT_NEAR(exact[0], (0.98 * 0.98 + 0.02 * 0.02 + 0.98) * 1e-4 / 4e-4, 1e-9);  // by Cramer
  EXPECT_TRUE(pinched.schur.solve(b, p));
  EXPECT_LT((p - exact).norm(), 1e-6 * exact.norm());
}

TEST(Schur, ForgetsTheMatrixOfAnotherBodyInTheSamePose) {
  const Model light = buildModel(sceneOf(oneStick())), heavy = buildModel(sceneOf(oneStick(2, 2)));
  Contact floor;
  floor.particle = {1};
  floor.weight = {1};
  floor.count = 1;
  Schur schur;
  const auto answer = [&](const Model& model) {
    const StickRows& rows = *model.systemOf(model.ragdolls[0]).direct.rows;
    StickSolver sticks;
    sticks.resize(rows);
    const State state = startState(model);
    sticks.setPose(rows, state.x.data());
    schur.start(0);
    schur.addContact(floor, 0);
    schur.assemble(rows, sticks);
    return schur.entry(0, 0);
  };
  answer(light);
  const double of_light = answer(light);
  schur.forget();
  EXPECT_NEAR(answer(heavy), of_light / 2, 1e-12 * of_light);
}

}  // namespace
}  // namespace ragdoll
