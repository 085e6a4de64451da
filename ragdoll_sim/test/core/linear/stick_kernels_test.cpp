// The kernels against Eigen, and the same bits from vectors of every width.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "core/linear/stick_kernels_body.h"
#include "ragdoll_sim/core/types.h"

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

/// Rows of `columns`, and three values for each of some of them.
struct Pushes {
  int columns;
  PaddedRows rows;
  std::vector<int> at;
  Points f;

  explicit Pushes(int n) : columns(paddedWidth(3 * n)), rows(PaddedRows::Zero(3 * n, columns)) {
    std::srand(static_cast<unsigned>(n));
    rows.leftCols(3 * n).setRandom();
    for (int i = 0; i < n && i < kernels::kMaxPushes; ++i) at.push_back((5 * i + 2) % n);
    f = Points::Random(3, static_cast<Eigen::Index>(at.size()));
  }
  int count() const { return static_cast<int>(at.size()); }

  template <class How>
  Eigen::VectorXd by(How how) const {
    Eigen::VectorXd out(columns);
    how(rows.data(), columns, at.data(), f.data(), count(), out.data());
    return out;
  }
};

TEST(StickKernels, spreadPushesIsASumOfRowsTimesForces) {
  for (int n = 1; n <= 30; ++n) {
    const Pushes p(n);
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(p.columns);
    for (int c = 0; c < 3 * n; ++c)
      for (int k = 0; k < p.count(); ++k) expected[c] += p.rows(p.at[k], c) * p.f(c % 3, k);
    EXPECT_EQ(p.by(kernels::spreadPushes), expected) << n;
    EXPECT_EQ(p.by([](auto... a) { kernels::body::spreadPushes<2>(a...); }), expected) << n;
    EXPECT_EQ(p.by([](auto... a) { kernels::body::spreadPushes<4>(a...); }), expected) << n;
    EXPECT_EQ(p.by([](auto... a) { kernels::body::spreadPushes<8>(a...); }), expected) << n;
  }
}

TEST(StickKernels, dotThreesIsASumOfDotProducts) {
  for (int n = 1; n <= 30; ++n)
    for (const int wanted : {paddedWidth(n), paddedWidth(3 * n)}) {
      const Pushes p(n);
      Eigen::VectorXd expected = Eigen::VectorXd::Zero(wanted);
      for (int c = 0; c < std::min(wanted, 3 * n); ++c)
        for (int k = 0; k < p.count(); ++k)
          expected[c] += p.f.col(k).dot(Vec3(p.rows.block<3, 1>(3 * p.at[k], c)));
      const auto by = [&](auto dots) {
        Eigen::VectorXd out = Eigen::VectorXd::Constant(p.columns, 7);
        dots(p.rows.data(), p.columns, wanted, p.at.data(), p.f.data(), p.count(), out.data());
        EXPECT_TRUE((out.tail(p.columns - wanted).array() == 7).all()) << n;  // left as they are
        return Eigen::VectorXd(out.head(wanted));
      };
      const Eigen::VectorXd sums = by(kernels::dotThrees);
      EXPECT_LT((sums - expected).norm(), 1e-14) << n;
      EXPECT_EQ(by([](auto... a) { kernels::body::dotThrees<2>(a...); }), sums) << n;
      EXPECT_EQ(by([](auto... a) { kernels::body::dotThrees<4>(a...); }), sums) << n;
      EXPECT_EQ(by([](auto... a) { kernels::body::dotThrees<8>(a...); }), sums) << n;
    }
}

TEST(StickKernels, sticksAreSpreadAndTheirRowsAddedUp) {
  for (int s = 1; s <= 30; ++s) {
    const int width = paddedWidth(s), columns = paddedWidth(s + 5);
    std::srand(static_cast<unsigned>(s));
    const PaddedRows D = PaddedRows::Random(3, width), rows = PaddedRows::Random(s, columns);
    PaddedRows spread(s, columns), narrow(s, columns), expected(s, columns);
    kernels::spreadSticks(D.data(), rows.data(), s, width, columns, spread.data());
    kernels::body::spreadSticks<2>(D.data(), rows.data(), s, width, columns, narrow.data());
    for (int c = 0; c < columns; ++c)
      expected.col(c) = rows.col(c).cwiseProduct(D.row(c % 3).head(s).transpose());
    EXPECT_EQ(spread, expected) << s;
    EXPECT_EQ(narrow, expected) << s;
    PaddedRows sum = PaddedRows::Ones(3, columns), other = sum;
    kernels::addRows(D.data(), s, width, rows.data(), columns, sum.data());
    kernels::body::addRows<2>(D.data(), s, width, rows.data(), columns, other.data());
    EXPECT_LT((sum - PaddedRows::Ones(3, columns) - D.leftCols(s) * rows).norm(), 1e-13) << s;
    EXPECT_EQ(sum, other) << s;
  }
}

}  // namespace
}  // namespace ragdoll
