#include "core/direct/mode_equalities.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "core/direct/mode_systems.h"

namespace ragdoll {
namespace {

using namespace test;

/// One contact that sticks, one that slips, one whose slip is impending, one whose force is known
/// and one that is open, at random: q of p = known + E q so that N^T (b + A p) = 0, by Eigen.
TEST(ModeEqualities, OfAllKindsAreTheDenseSolution) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  const int size = 15;
  for (int sample = 0; sample < 20; ++sample) {
    const Eigen::MatrixXd root =
        Eigen::MatrixXd::NullaryExpr(size, 2 * size, [&] { return normal(random); });
    const Eigen::MatrixXd A = root * root.transpose() / size;
    const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(size, [&] { return normal(random); });
    std::vector<ModeBlock> blocks;
    for (int row = 0; row < size; row += 3) {
      blocks.push_back(contactRows(row, 0.3));
      blocks.back().presses = row != 12;
      blocks.back().slip = Eigen::Vector2d(normal(random), normal(random)).normalized();
    }
    blocks[0].sticks = blocks[2].impending = blocks[3].given = true;
    blocks[3].force = 2;
    const auto along = [&](int i) { return -0.3 * blocks[i].slip; };
    Eigen::VectorXd known = Eigen::VectorXd::Zero(size);
    known.segment<3>(9) << 2, 2 * along(3);
    Eigen::MatrixXd N = Eigen::MatrixXd::Identity(size, 6);
    N.rightCols<2>().setZero();
    N(6, 4) = 1;
    N.col(5).segment<2>(7) = blocks[2].across();
    Eigen::MatrixXd E = N;
    E.col(3).segment<2>(4) = along(1);
    E.col(4).segment<2>(7) = along(2);
    const Eigen::VectorXd q =
        -(N.transpose() * A * E).fullPivLu().solve(N.transpose() * (b + A * known));
    const Eigen::VectorXd expected = known + E * q;
    ModeVector p;
    ASSERT_TRUE(solveEqualities(A, b, blocks, p));
    EXPECT_LT((p - expected).norm(), 1e-11 * expected.norm()) << sample;
    EXPECT_EQ(p.tail(3).norm(), 0);
  }
}

/// The normal forces of the table's feet if rows, scaled to a unit diagonal, gave way by `soft`.
Eigen::VectorXd softForces(const SlidingTable& table, double friction, double soft) {
  Eigen::MatrixXd C(table.kFeet, table.kFeet);
  Eigen::VectorXd scale(table.kFeet);
  for (int i = 0; i < table.kFeet; ++i) {
    scale[i] = 1 / std::sqrt(table.A(3 * i, 3 * i));
    for (int j = 0; j < table.kFeet; ++j)
      C(i, j) = table.A(3 * i, 3 * j) -
                friction * table.A.row(3 * i).segment(3 * j + 1, 2).dot(table.blocks[j].slip);
  }
  C = scale.asDiagonal() * C * scale.asDiagonal();
  C.diagonal().array() += soft;
  return scale.asDiagonal() * C.fullPivLu().solve(kG * scale);
}

/// Four feet carry what three could: as on springs that hardly give way, with friction, too.
TEST(ModeEqualities, ThatDependOnEachOtherShareALoadAsSprings) {
  for (const double friction : {0.0, 0.4}) {
    const SlidingTable table(friction);
    ModeVector p;
    ASSERT_TRUE(solveEqualities(table.A, table.b, table.blocks, p));
    const double weight = table.mass * kG;
    EXPECT_LT((table.force(p) - weight * Vec3(-0.6 * friction, -0.8 * friction, 1)).norm(), 1e-11);
    EXPECT_LT(table.moment(p).head<2>().norm(), 1e-11);
    const Eigen::VectorXd soft = softForces(table, friction, 1e-8);
    for (int i = 0; i < table.kFeet; ++i) EXPECT_NEAR(p[3 * i], soft[i], 1e-5) << i;
  }
}

TEST(ModeEqualities, ThatContradictEachOtherHaveNoSolution) {
  SlidingTable table(0.4);
  ModeVector p;
  table.b[0] += 0.01;  // a foot that would leave the plane of the others
  EXPECT_FALSE(solveEqualities(table.A, table.b, table.blocks, p));
}

/// Feet whose velocities differ by less than what lets go still have a common one.
TEST(ModeEqualities, LeaveWhatTheyMay) {
  SlidingTable table(0);
  table.b.setZero();
  table.b[0] = 4e-10;
  ModeVector p;
  EXPECT_FALSE(solveEqualities(table.A, table.b, table.blocks, p));
  ASSERT_TRUE(solveEqualities(table.A, table.b, table.blocks, p, kLeaving));
  for (int i = 0; i < table.kFeet; ++i)  // the middle of a plane through the four
    EXPECT_LT(std::abs((table.b + table.A * p)[3 * i]), 3e-10) << i;
}

/// An angle may be in degrees: p then changes as its row's unit does, and how a load is shared not
/// at all.
TEST(ModeEqualities, DoNotDependOnUnits) {
  const SlidingTable table(0);
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(table.b.size());
  unit[0] = 180 / M_PI;
  unit[3] = 1e-3;
  const ModeMatrix A = unit.asDiagonal() * table.A * unit.asDiagonal();
  const ModeVector b = unit.cwiseProduct(table.b);
  ModeVector p, other;
  ASSERT_TRUE(solveEqualities(table.A, table.b, table.blocks, p));
  ASSERT_TRUE(solveEqualities(A, b, table.blocks, other));
  EXPECT_LT((unit.cwiseProduct(other) - p).norm(), 1e-11 * p.norm());
}

TEST(ModeEqualities, OfWhatCannotMoveTakeNoForce) {
  ModeMatrix A = ModeMatrix::Zero(6, 6);
  A.topLeftCorner(3, 3).diagonal() << 0.5, 0.25, 1;
  std::vector<ModeBlock> blocks{contactRows(0, 0.5), contactRows(3, 0.5)};
  for (ModeBlock& block : blocks) block.presses = block.sticks = true;
  EXPECT_DOUBLE_EQ(normalScale(A, blocks[0]), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(tangentScale(A, blocks[0]), 1);  // of the one that answers more
  EXPECT_EQ(normalScale(A, blocks[1]), 0);
  EXPECT_EQ(tangentScale(A, blocks[1]), 0);
  ModeVector p;
  ASSERT_TRUE(solveEqualities(A, ModeVector::Constant(6, -1), blocks, p));
  EXPECT_LT((p.head(3) - Vec3(2, 4, 1)).norm(), 1e-14);
  EXPECT_EQ(p.tail(3).norm(), 0);
}

}  // namespace
}  // namespace ragdoll
