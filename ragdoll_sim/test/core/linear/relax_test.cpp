#include "core/linear/relax.h"

#include <gtest/gtest.h>

namespace ragdoll {
namespace {

RelaxedStick stickOf(double length, double share_a, double share_b) {
  RelaxedStick s;
  s.a = 0;
  s.b = 1;
  s.length = length;
  s.share_a = share_a;
  s.share_b = share_b;
  return s;
}

/// A stick of 1 m drawn to 2 m between 1 and 3 kg: the light end goes three quarters of the way.
TEST(Relax, SharesTheCorrectionByInverseMass) {
  Points x(3, 2);
  x << 0, 2, 0, 0, 0, 0;
  relaxSticks({stickOf(1, 0.75, 0.25)}, x.data());
  EXPECT_DOUBLE_EQ(x(0, 0), 0.75);
  EXPECT_DOUBLE_EQ(x(0, 1), 1.75);
}

TEST(Relax, PartsEndsThatCoincide) {
  Points x = Points::Zero(3, 2);
  relaxSticks({stickOf(1, 0.5, 0.5)}, x.data());
  EXPECT_NEAR((x.col(1) - x.col(0)).norm(), 1, 2 * kMinLength);
}

/// With a diagonal mass matrix both ways are one.
TEST(Relax, CoupledIsTheSameWhereNothingIsCoupled) {
  Points x(3, 2), y;
  x << 0.1, 1.4, -0.2, 0.3, 0.5, 0.4;
  y = x;
  const std::vector<RelaxedStick> sticks{stickOf(1, 0.75, 0.25)};
  Eigen::MatrixXd BW(1, 2);
  BW << -1, 1.0 / 3;  // b W of 1 and 3 kg
  Eigen::VectorXd G(1);
  G << 4.0 / 3;
  relaxSticks(sticks, x.data());
  relaxCoupledSticks(sticks, BW, G, y);
  EXPECT_LT((x - y).norm(), 1e-15);
  G << 0;  // cannot move
  Points z = y;
  z.col(1) *= 2;
  const Points before = z;
  relaxCoupledSticks(sticks, BW, G, z);
  EXPECT_EQ(z, before);
}

}  // namespace
}  // namespace ragdoll
