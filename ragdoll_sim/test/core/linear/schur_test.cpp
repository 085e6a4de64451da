// Contacts that all but contradict each other: what sweeps of Gauss-Seidel alone do not find.
#include "core/linear/schur.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "ragdoll_sim/core/build_model.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// A stick whose end b lies on the floor, and which something presses down near that end.
class Pinched {
 public:
  Pinched(double nearness, double friction) : model_(buildModel(sceneOf(oneStick()))) {
    const StickRows& rows = *model_.systemOf(model_.ragdolls[0]).direct.rows;
    StickSolver sticks;
    sticks.resize(rows);
    const State state = startState(model_);
    sticks.setPose(rows, state.x.data());
    Contact floor, above;
    floor.particle = {1};
    floor.weight = {1};
    floor.count = 1;
    above.particle = {0, 1};
    above.weight = {nearness, 1 - nearness};
    above.count = 2;
    above.normal = -Vec3::UnitZ();
    floor.friction = above.friction = friction;
    schur.start(0);
    schur.addContact(floor, 0);
    schur.addContact(above, 1);
    schur.assemble(rows, sticks);
  }

  Schur schur;

 private:
  Model model_;
};

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
