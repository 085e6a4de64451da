// What sweeps of Gauss-Seidel alone do not find: contacts that all but contradict each other, and
// what presses through light bodies.
#include "core/linear/sweep_batches.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/linear/pinched.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(SweepBatches, GoOnWhereTheSweepsGaveUp) {
  constexpr double kMu = 0.5;
  Pinched pinched(0.02, kMu);
  RowValues b, p;
  b.setZero(6);
  p.setZero(6);
  b << -1e-4, 2e-5, 0.3, -1e-4, 0, 1e-5;  // the floor slides by 0.3 m: the cone is reached there
  EXPECT_FALSE(pinched.joint.solve(b, p));
  EXPECT_TRUE(pinched.joint.solveOn(b, p));
  const Eigen::VectorXd w = b + pinched.schur.matrix() * p;
  for (int i = 0; i < 6; i += 3) {
    EXPECT_GT(p[i], 0);
    EXPECT_NEAR(w[i], 0, 1e-6);
    const Eigen::Vector2d pull = p.segment<2>(i + 1), slip = w.segment<2>(i + 1);
    const double spare = kMu * p[i] - pull.norm();
    EXPECT_GT(spare, -1e-12);
    if (spare > 1e-9)
      EXPECT_LT(slip.norm(), 1e-6) << i;  // sticks
    else
      EXPECT_LT((slip / slip.norm() + pull / pull.norm()).norm(), 1e-3) << i;  // against the slip
  }
}

TEST(SweepBatches, SaySoWhereNothingCanOpen) {
  Pinched pinched(0, 0);  // pressed down right above the floor
  RowValues b, p;
  b.setZero(2);
  b << -1e-4, -1e-4;
  p.setZero(2);
  EXPECT_FALSE(pinched.joint.solve(b, p));
  const double before = p.norm();
  EXPECT_FALSE(pinched.joint.solveOn(b, p));
  EXPECT_LE(p.norm(), 1e4 * before);
}

/// Two light bodies under one of 1000 times their mass: each sweep leaves 1 - 1/1000 and
/// 1 - 1/2000 of what is wrong, in two directions.
TEST(SweepBatches, FindWhatPressesThroughLightBodies) {
  const Eigen::Vector2d exact(3, 5), keeps(1 - 1e-3, 1 - 5e-4);
  std::vector<SchurBlock> blocks(2);
  blocks[1].row = 1;
  RowValues answers, p;
  answers.setZero(2);
  answers << 1, 1;
  p.setZero(2);
  int batches = 0;
  const auto sweep = [&](RowValues& of) {
    ++batches;
    Eigen::Vector2d off = of - exact;
    for (int i = 0; i < kBatch; ++i) {
      const Eigen::Vector2d sum(off[0] + off[1], off[0] - off[1]);
      const Eigen::Vector2d kept = keeps.cwiseProduct(sum);
      off = 0.5 * Eigen::Vector2d(kept[0] + kept[1], kept[0] - kept[1]);
    }
    of = exact + off;
    return off.norm() < 1e-9 * exact.norm();
  };
  SweepBatches on;
  EXPECT_TRUE(on.solve(blocks, answers, sweep, p));
  EXPECT_LT((p - exact).norm(), 1e-8);
  EXPECT_LE(batches, 6);  // alone 4000
}

}  // namespace
}  // namespace ragdoll
