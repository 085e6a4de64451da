#include "core/direct/mode_piece.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/mode_body.h"
#include "support/integrate.h"

namespace ragdoll {
namespace {

using namespace test;

/// What a rod is off by after h, its end stuck: from the pendulum's equation of one angle.
double errorOfPendulum(double h) {
  const double tilt = 1.1, rate = 3;
  ModeBody rod(rodOnEnd(5, tilt, rate));
  EXPECT_TRUE(rod.start());
  EXPECT_TRUE(rod.row(0).sticks);
  ModePoint end;
  EXPECT_TRUE(moveInMode(rod.island, h, end, rod.island.s.mode.piece));
  const auto pendulum = [](const Eigen::Vector2d& s) {
    return Eigen::Vector2d(s[1], -kG * std::cos(s[0]));
  };
  const double angle = integrate(pendulum, Eigen::Vector2d(tilt, rate), h)[0];
  return (ModeBody::of(end.x, 1) - Vec3(std::cos(angle), 0, std::sin(angle))).norm();
}

TEST(ModePiece, IsOfFifthOrder) {
  const double coarse = errorOfPendulum(0.08), fine = errorOfPendulum(0.04);
  EXPECT_LT(coarse, 1e-5);
  EXPECT_GT(coarse / fine, 30);
}

/// x, v, a of a motion whose coordinates are polynomials.
ModePoint polynomial(int degree, double t) {
  ModePoint p;
  p.x = p.v = p.a = Eigen::VectorXd::Zero(4);
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k <= degree; ++k) {
      const double c = std::cos(3.0 * i + 2 * k);  // any
      p.x[i] += c * std::pow(t, k);
      if (k > 0) p.v[i] += c * k * std::pow(t, k - 1);
      if (k > 1) p.a[i] += c * k * (k - 1) * std::pow(t, k - 2);
    }
  return p;
}

TEST(ModePiece, IsInterpolatedExactlyUpToDegreeFiveAndThreeOfItsVelocities) {
  const double begin = 0.3, h = 1.7;
  for (const int degree : {5, 4}) {
    const ModePoint start = polynomial(degree, begin), end = polynomial(degree, begin + h);
    ModePoint out;
    for (const double share : {0.0, 0.1, 0.5, 0.8, 1.0}) {
      interpolate(start, end, h, share, out);
      const ModePoint exact = polynomial(degree, begin + share * h);
      EXPECT_LT((out.x - exact.x).norm(), 1e-12) << share;
      if (degree == 4) {
        EXPECT_LT((out.v - exact.v).norm(), 1e-12) << share;
      }
    }
  }
}

/// Where slips begin pieces are as short as 1e-8 s.
TEST(ModePiece, IsInterpolatedWithoutRoundingInAShortPiece) {
  const double h = 1e-8;
  ModePoint start, end, out;
  start.x = end.x = Eigen::VectorXd::Constant(3, 1.3);
  start.v = Eigen::VectorXd::Zero(3);
  start.a = end.a = Eigen::VectorXd::Constant(3, 2);
  end.v = h * start.a;
  end.x += 0.5 * h * end.v;
  interpolate(start, end, h, 0.5, out);
  EXPECT_LT((out.v - 0.5 * end.v).norm(), 1e-16);
}

}  // namespace
}  // namespace ragdoll
