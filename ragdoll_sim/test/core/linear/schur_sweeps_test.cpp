// Projected Gauss-Seidel against problems whose solutions are known.
#include "core/linear/schur_sweeps.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

namespace ragdoll {
namespace {

/// Rows of a matrix, as the sweeps want them; counts them.
struct DenseRows {
  Eigen::MatrixXd A;
  Eigen::VectorXd w, unheld;  ///< unheld: the diagonal without sticks
  std::vector<Schur::Row> rows;
  int pushes = 0;

  DenseRows(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& b)
      : A(matrix), w(b), unheld(matrix.diagonal()) {
    for (Eigen::Index i = 0; i < b.size(); ++i) {
      rows.emplace_back();
      rows.back().kind = Schur::Row::Kind::kLimit;
    }
  }

  /// Rows `first`, + 1 and + 2 are a contact with this friction.
  void setContact(int first, double friction) {
    rows[first].kind = Schur::Row::Kind::kNormal;
    rows[first].friction = friction;
    for (int k = 1; k < 3; ++k) rows[first + k].kind = Schur::Row::Kind::kTangent;
  }

  int size() const { return static_cast<int>(rows.size()); }
  const Schur::Row& row(int i) const { return rows[i]; }
  double matrix(int i, int j) const { return A(i, j); }
  double free(int i) const { return unheld[i]; }
  double rate(int i) const { return w[i]; }
  void push(int i, int count, const double* step) {
    for (int k = 0; k < count; ++k) w += step[k] * A.row(i + k).transpose();
    ++pushes;
  }

  bool solve(Eigen::VectorXd& p, Sweeps sweeps = Sweeps::kToTheEnd) {
    std::vector<SchurBlock> blocks;
    findBlocks(*this, blocks);
    return projectedGaussSeidel(*this, blocks, p.data(), sweeps);
  }
};

/// Its diagonal is 1, everything else `coupling`: bodies that stand on many points at once.
Eigen::MatrixXd coupled(int m, double coupling) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Constant(m, m, coupling);
  A.diagonal().setOnes();
  return A;
}

TEST(SchurSweeps, FindTheImpulsesThatPress) {
  const int m = 8;
  const Eigen::MatrixXd A = coupled(m, 0.7);
  Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(m, -2, -1);
  b[3] = 5;  // far: takes no part
  Eigen::VectorXd p = Eigen::VectorXd::Zero(m);
  DenseRows rows(A, b);
  ASSERT_TRUE(rows.solve(p));
  for (int i = 0; i < m; ++i) {
    EXPECT_GE(p[i], 0) << i;
    EXPECT_GE(rows.w[i], -1e-6) << i;
    EXPECT_NEAR(p[i] * rows.w[i], 0, 1e-6) << i;
  }
  EXPECT_LT((rows.w - b - A * p).norm(), 1e-12);  // what it works with is what p gives
  EXPECT_EQ(p[3], 0);
  EXPECT_GT(p[0], 0.1);
}

/// Of two rows with coupling c a sweep leaves c^2 of what is wrong: 1e-7 takes ln 1e-7 / ln c^2.
TEST(SchurSweeps, GoOnToTheEndOfAGeometricSequence) {
  for (const double coupling : {0.7, 0.9, 0.97}) {
    const Eigen::MatrixXd A = coupled(2, coupling);
    const Eigen::Vector2d b(-1, -1.01);
    Eigen::VectorXd p = Eigen::VectorXd::Zero(2);
    DenseRows rows(A, b);
    ASSERT_TRUE(rows.solve(p));
    EXPECT_LT((p - A.inverse() * -b).norm(), 1e-5) << coupling;
    const double plain = 2 * std::log(1e-7) / std::log(coupling * coupling);
    EXPECT_LT(rows.pushes, 0.3 * plain) << coupling;
  }
}

/// Six rows that hardly differ, beside one that has a thousand times their impulse.
TEST(SchurSweeps, OfAnImpactFindSmallImpulsesBesideALargeOne) {
  const int m = 7;
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(m, m);
  for (int i = 1; i < m; ++i)
    for (int j = 1; j < m; ++j) A(i, j) = std::pow(0.9, std::abs(i - j));
  Eigen::VectorXd exact(m);
  exact << 100, 0.1, 0.15, 0.05, 0.2, 0.1, 0.12;
  const auto worst = [&](Sweeps sweeps) {
    DenseRows rows(A, -A * exact);
    Eigen::VectorXd p = Eigen::VectorXd::Zero(m);
    EXPECT_TRUE(rows.solve(p, sweeps));
    return (p - exact).cwiseAbs().maxCoeff();
  };
  EXPECT_GT(worst(Sweeps::kToTheEnd), 1e-6);
  EXPECT_LT(worst(Sweeps::kOfAnImpact), 1e-8);
}

TEST(SchurSweeps, FrictionStaysInItsDisc) {
  // Slides along (3, 4): the friction is 0.5 of the normal impulse, against the slip.
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(3, 3);
  Eigen::VectorXd p = Eigen::VectorXd::Zero(3);
  DenseRows rows(A, Eigen::Vector3d(-2, 3, 4));
  rows.setContact(0, 0.5);
  ASSERT_TRUE(rows.solve(p));
  EXPECT_LT((p - Eigen::Vector3d(2, -0.6, -0.8)).norm(), 1e-6);
}

/// As of a pinned rod, which cannot move along itself: across, friction holds it nevertheless.
TEST(SchurSweeps, FrictionHoldsBesideADirectionThatIsLocked) {
  for (const int locked : {1, 2}) {
    const int moves = 3 - locked;
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(3, 3);
    A(locked, locked) = 1e-17;  // what rounding leaves of nothing
    DenseRows rows(A, Eigen::Vector3d(-2, 0, 0));
    rows.unheld.setOnes();
    rows.w[moves] = 0.75;
    rows.setContact(0, 0.5);
    Eigen::VectorXd p = Eigen::VectorXd::Zero(3);
    ASSERT_TRUE(rows.solve(p));
    EXPECT_NEAR(p[moves], -0.75, 1e-6);
    EXPECT_NEAR(rows.w[moves], 0, 1e-6);
    EXPECT_EQ(p[locked], 0);
  }
}

TEST(SchurSweeps, FrictionAlongTheSlipKeepsItsDirection) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(3, 3);
  const auto solveFrom = [&](const Eigen::Vector3d& first) {
    Eigen::VectorXd p = first;
    DenseRows rows(A, Eigen::Vector3d(-2, 3, 4));
    rows.setContact(0, 0.5);
    EXPECT_TRUE(rows.solve(p, Sweeps::kAlongTheSlip));
    return Eigen::Vector3d(p);
  };
  const Eigen::Vector3d along(2, 0, -1), against_the_slip(2, -0.6, -0.8);
  EXPECT_LT((solveFrom({2, 0, -1}) - along).norm(), 1e-6);
  EXPECT_LT((solveFrom({1, 0, -0.5}) - along).norm(), 1e-6);             // of the pressure there is
  EXPECT_LT((solveFrom({2, 0, -0.9}) - against_the_slip).norm(), 1e-6);  // stuck at first
  EXPECT_LT((solveFrom({2, 0, 1}) - against_the_slip).norm(), 1e-6);     // with the slip
}

/// A light ball between a floor and a heavy one: a sweep leaves all but m / M of what is wrong.
TEST(SchurSweeps, FindWhatPressesThroughALightBody) {
  for (const double light : {1e-1, 1e-2, 1e-4}) {
    Eigen::MatrixXd A(2, 2);
    A << 1 / light, -1 / light, -1 / light, 1 / light + 1;
    const Eigen::Vector2d b(0, -1);  // the heavy one, of 1 kg, comes at 1 m/s
    Eigen::VectorXd p = Eigen::VectorXd::Zero(2);
    DenseRows rows(A, b);
    ASSERT_TRUE(rows.solve(p)) << light;
    EXPECT_LT((p - Eigen::Vector2d(1, 1)).norm(), 1e-3) << light;
    EXPECT_LT(rows.pushes, 60) << light;
  }
}

TEST(SchurSweeps, GiveUpWhereImpulsesGrowWithoutEnd) {
  // The same row from both sides, each of which wants to move away from the other.
  Eigen::MatrixXd A(2, 2);
  A << 1, -1, -1, 1;
  Eigen::VectorXd p = Eigen::VectorXd::Zero(2);
  DenseRows rows(A, Eigen::Vector2d(-1e-3, -1e-3));
  EXPECT_FALSE(rows.solve(p));
  EXPECT_TRUE((p.array() >= 0).all());
  EXPECT_LT(p.maxCoeff(), 0.1);
  EXPECT_LT(rows.pushes, 20);
  // All but the same: a leap is no nearer, and taken back.
  A(1, 1) = 1 + 1e-13;
  p.setZero();
  DenseRows almost(A, Eigen::Vector2d(-1e-3, -1e-3));
  EXPECT_FALSE(almost.solve(p));
  EXPECT_LT(p.maxCoeff(), 0.1);
}

}  // namespace
}  // namespace ragdoll
