#include "core/direct/mode_newton.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "core/direct/mode_systems.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kNear = 1e-6;  ///< as rows give way by 1e-8

/// Rows that only push, at random.
struct PushingRows {
  static constexpr int kCount = 5;
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  std::vector<ModeBlock> blocks;

  explicit PushingRows(std::mt19937& random) {
    std::normal_distribution<double> normal;
    const Eigen::MatrixXd root =
        Eigen::MatrixXd::NullaryExpr(kCount, 2 * kCount, [&] { return normal(random); });
    A = root * root.transpose() / kCount;
    b = Eigen::VectorXd::NullaryExpr(kCount, [&] { return normal(random); });
    for (int row = 0; row < kCount; ++row) blocks.push_back(contactRows(row, 0));
  }
  /// Of all sets of rows that may press, the one whose forces and rates are not negative.
  Eigen::VectorXd solution() const {
    for (int set = 0; set < 1 << kCount; ++set) {
      Eigen::MatrixXd C = Eigen::MatrixXd::Identity(kCount, kCount);
      Eigen::VectorXd rhs = Eigen::VectorXd::Zero(kCount);
      for (int i = 0; i < kCount; ++i)
        if (set >> i & 1) C.row(i) = A.row(i), rhs[i] = -b[i];
      Eigen::VectorXd p = C.fullPivLu().solve(rhs);
      if (p.minCoeff() >= 0 && (b + A * p).minCoeff() >= -1e-12) return p;
    }
    return {};
  }
};

void expectCoulomb(const ModeVector& rates, const ModeVector& forces, double mu) {
  const double size = 1 + forces.norm(), near = kNear * size;
  for (int i = 0; i < forces.size(); i += 3) {
    const Eigen::Vector2d friction = forces.segment<2>(i + 1), slip = rates.segment<2>(i + 1);
    EXPECT_GE(forces[i], -near);
    EXPECT_GE(rates[i], -near);
    EXPECT_NEAR(forces[i] * rates[i], 0, near * size);
    EXPECT_LE(friction.norm(), mu * forces[i] + near);
    EXPECT_NEAR(friction.dot(slip), -mu * forces[i] * slip.norm(), near * size);
  }
}

TEST(ModeNewton, FindsWhichRowsPress) {
  std::mt19937 random(7);
  for (int sample = 0; sample < 100; ++sample) {
    const PushingRows rows(random);
    ModeVector p = ModeVector::Zero(rows.kCount);
    ASSERT_TRUE(approachComplementarity(rows.A, rows.b, rows.blocks, p));
    EXPECT_LT((p - rows.solution()).norm(), kNear * (1 + p.norm())) << sample;
  }
}

/// Ten contacts at random, of 1 N each to begin with. Strong friction has no answer at times, and
/// takes softer rows to begin with (kSoftest).
TEST(ModeNewton, FrictionOpposesTheSlipThatItLeaves) {
  constexpr int kRows = 30, kSamples = 200;
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  for (const double mu : {0.4, 2.0}) {
    int found = 0;
    for (int sample = 0; sample < kSamples; ++sample) {
      const Eigen::MatrixXd root =
          Eigen::MatrixXd::NullaryExpr(kRows, kRows, [&] { return normal(random); });
      const ModeMatrix A = root * root.transpose() / kRows;
      const ModeVector b = ModeVector::NullaryExpr(kRows, [&] { return normal(random); });
      std::vector<ModeBlock> blocks;
      for (int row = 0; row < kRows; row += 3) blocks.push_back(contactRows(row, mu));
      ModeVector p = ModeVector::Ones(kRows);
      if (!approachComplementarity(A, b, blocks, p)) continue;
      ++found;
      expectCoulomb(b + A * p, p, mu);
    }
    EXPECT_GT(found, kSamples - 10) << mu;
  }
}

/// The load of four feet is that of springs (SharedLoad), whatever was guessed.
TEST(ModeNewton, SharesALoadWhateverItBeginsWith) {
  for (const double friction : {0.0, 0.4}) {
    const SlidingTable table(friction);
    ModeVector expected, p = ModeVector::Zero(table.b.size());
    ASSERT_TRUE(solveEqualities(table.A, table.b, table.blocks, expected));
    for (const double guess : {0.0, 1.0, 100.0}) {
      p.setZero();
      p[0] = p[6] = guess;
      ASSERT_TRUE(approachComplementarity(table.A, table.b, table.blocks, p));
      EXPECT_LT((p - expected).norm(), kNear * expected.norm()) << friction << " " << guess;
    }
  }
}

/// A spring presses with 6 N: what pulls by less than its friction is held, what pulls by more
/// slips.
TEST(ModeNewton, AKnownForceBoundsItsFriction) {
  const double mass = 2, mu = 0.5;
  const ModeMatrix A = ModeMatrix::Identity(3, 3) / mass;
  ModeBlock spring = contactRows(0, mu);
  spring.presses = spring.given = true;
  spring.force = 6;
  for (const double pull : {1.0, 5.0}) {
    ModeVector p = ModeVector::Zero(3);
    ASSERT_TRUE(approachComplementarity(A, pull * Vec3(1, 0.6, -0.8), {spring}, p));
    const double holds = std::min(pull * mass, mu * 6);
    EXPECT_LT((p - Vec3(6, -0.6 * holds, 0.8 * holds)).norm(), kNear * 6) << pull;
  }
}

/// Painleve's rod, whose friction presses it harder than it is held: no force is an answer.
TEST(ModeNewton, LeavesWhatItFindsNoAnswerTo) {
  const LeaningRod rod(1.1);
  ModeBlock moving = contactRows(0, 3);
  moving.slips = true;
  moving.slip = Eigen::Vector2d(0, -1);
  const ModeVector before = Vec3(1, 0, 3);
  ModeVector p = before;
  EXPECT_FALSE(approachComplementarity(rod.A, rod.b, {moving}, p));
  EXPECT_EQ(p, before);
}

}  // namespace
}  // namespace ragdoll
