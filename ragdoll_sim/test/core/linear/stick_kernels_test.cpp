// The kernels against Eigen, and the same bits from vectors of every width.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cstdlib>
#include <vector>

#include "core/linear/stick_kernels_body.h"

namespace ragdoll {
namespace {

constexpr double kFloor = 1e-12;

/// Symmetric, positive definite.
Eigen::MatrixXd someSystem(int s) {
  std::srand(static_cast<unsigned>(s));
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(s, s + 5);
  return A * A.transpose() + 0.1 * Eigen::MatrixXd::Identity(s, s);
}

PaddedRows padded(const Eigen::MatrixXd& S) {
  const int s = static_cast<int>(S.rows());
  PaddedRows rows = PaddedRows::Zero(s + s % 2, paddedWidth(s));
  rows.topLeftCorner(s, s) = S;
  return rows;
}

/// Inverse by `how`; the padding has to stay zero.
template <class How>
PaddedRows inverseBy(How how, const Eigen::MatrixXd& S, int dependent = 0) {
  const int s = static_cast<int>(S.rows());
  PaddedRows rows = padded(S);
  std::vector<double> work(3 * rows.cols());
  EXPECT_EQ(how(rows.data(), s, static_cast<int>(rows.cols()), kFloor, work.data()), dependent);
  EXPECT_EQ(rows.rightCols(rows.cols() - s).cwiseAbs().sum(), 0) << s;
  return rows;
}

TEST(StickKernels, invertOfAnySize) {
  for (int s = 1; s <= 70; ++s) {
    const Eigen::MatrixXd S = someSystem(s), expected = S.inverse();
    const PaddedRows inverse = inverseBy(kernels::invert, S);
    EXPECT_LT((inverse.topLeftCorner(s, s) - expected).norm() / expected.norm(), 1e-11) << s;
  }
}

TEST(StickKernels, aDependentStickTakesNoImpulse) {
  for (const int gone : {0, 3, 8, 16}) {
    const int s = 17;
    Eigen::MatrixXd S = someSystem(s);
    const Eigen::MatrixXd before = S.topLeftCorner(gone, gone);
    if (gone > 0) {  // as the first of all
      S.row(gone) = S.row(0);
      S.col(gone) = S.col(0);
      S(gone, gone) = S(0, 0);
    } else {
      S.row(0).setZero();
      S.col(0).setZero();
    }
    const PaddedRows inverse = inverseBy(kernels::invert, S, 1);
    EXPECT_EQ(inverse.row(gone).cwiseAbs().sum(), 0) << gone;
    EXPECT_EQ(inverse.col(gone).cwiseAbs().sum(), 0) << gone;
  }
}

TEST(StickKernels, widthOfVectorsDoesNotChangeABit) {
  for (int s = 1; s <= 40; ++s) {
    const Eigen::MatrixXd S = someSystem(s);
    const PaddedRows chosen = inverseBy(kernels::invert, S);
    EXPECT_EQ(inverseBy(kernels::body::invert<2>, S), chosen) << s;
    EXPECT_EQ(inverseBy(kernels::body::invert<4>, S), chosen) << s;
    EXPECT_EQ(inverseBy(kernels::body::invert<8>, S), chosen) << s;
    const Eigen::VectorXd b = Eigen::VectorXd::Random(chosen.cols());
    Eigen::VectorXd product(chosen.cols()), other(chosen.cols());
    const int width = static_cast<int>(chosen.cols());
    kernels::multiply(chosen.data(), b.data(), s, width, product.data());
    kernels::body::multiply<2>(chosen.data(), b.data(), s, width, other.data());
    EXPECT_EQ(product, other) << s;
  }
}

}  // namespace
}  // namespace ragdoll
