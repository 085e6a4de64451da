#include "core/linear/anderson.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace ragdoll {
namespace {

Eigen::VectorXd vectorOf(double a, double b) {
  Eigen::VectorXd v = Eigen::VectorXd::Zero(4);  // of two, gcc 12 warns of memory that is not there
  v[0] = a;
  v[1] = b;
  return v;
}

/// x <- M x + c with eigenvalues up to 0.999: alone 16000 times for what three changes tell.
TEST(Anderson, SolvesALinearIterationFromAsManyChangesAsItHasEigenvalues) {
  const Eigen::Vector3d rates(0.999, 0.9, -0.5), c(1, 2, 3);
  const Eigen::Matrix3d Q =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Matrix3d M = Q * rates.asDiagonal() * Q.transpose();
  const Eigen::Vector3d fixed = (Eigen::Matrix3d::Identity() - M).inverse() * c;
  Anderson anderson;
  RowValues before, result, better;
  before.setZero(3);
  anderson.start();
  for (int i = 0; i < 4; ++i) {
    result = M * before + c;
    ASSERT_TRUE(anderson.mix(before, result, better)) << i;
    before = better;
  }
  EXPECT_LT((before - fixed).norm(), 1e-8 * fixed.norm());
}

TEST(Anderson, SaysThatADriftHasNoEnd) {
  Anderson anderson;
  RowValues before, result, better;
  before.setZero(4);
  result = vectorOf(1, -1);
  anderson.start();
  EXPECT_TRUE(anderson.mix(before, result, better));
  before = result;
  result = vectorOf(2, -2);
  EXPECT_FALSE(anderson.mix(before, result, better));
}

/// Changes along one line only: the second tells nothing new, and does no harm.
TEST(Anderson, TakesDependentChangesOnce) {
  Anderson anderson;
  RowValues before, result, better;
  before = vectorOf(1, 0);
  anderson.start();
  for (int i = 0; i < 3; ++i) {
    result = vectorOf(0.5 * before[0] + 1, 0);
    ASSERT_TRUE(anderson.mix(before, result, better));
    ASSERT_TRUE(better.allFinite());
    before = i == 0 ? result : better;
  }
  EXPECT_NEAR(better[0], 2, 1e-12);
}

}  // namespace
}  // namespace ragdoll
