// Impulses that are spread against what balance, cones and the nearest point say.
#include "world/cone_balance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace ragdoll {
namespace {

const Vec3 kUp(0, 0, 1);

double normalOf(const SharedImpulse& s) { return s.impulse.dot(s.normal); }
double tangentOf(const SharedImpulse& s) { return (s.impulse - normalOf(s) * s.normal).norm(); }

/// [N s] by how much an impulse lies outside its cone.
double outside(const SharedImpulse& s) {
  return std::max(-normalOf(s), tangentOf(s) - s.friction * std::max(0.0, normalOf(s)));
}

std::vector<Vec3> sumsOf(const std::vector<SharedImpulse>& all, std::size_t bodies) {
  std::vector<Vec3> sums(bodies, Vec3::Zero());
  for (const SharedImpulse& s : all) {
    if (s.first >= 0) sums[s.first] += s.impulse;
    if (s.second >= 0) sums[s.second] -= s.impulse;
  }
  return sums;
}

TEST(ConeBalance, WedgeCarriesWithBothOfItsFaces) {
  const double s = std::sqrt(0.5);
  std::vector<SharedImpulse> faces = {{0, -1, 1, 0, Vec3(s, 0, s), Vec3::Zero()},
                                      {0, -1, 3, 0, Vec3(-s, 0, s), Vec3::Zero()}};
  spreadWithinCones({10 * kUp}, faces);
  for (const SharedImpulse& face : faces) {
    EXPECT_NEAR(normalOf(face), 10 * s, 1e-9);
    EXPECT_NEAR(tangentOf(face), 0, 1e-9);
  }
}

TEST(ConeBalance, WhatOneCannotHoldTheOtherDoes) {
  // A push of 6 to the side on two supports of 5 each: the rough one takes up to its cone's 0.8 of
  // what presses it, and the smooth one nothing.
  std::vector<SharedImpulse> two = {{0, -1, 1, 0, kUp, 5 * kUp}, {0, -1, 1, 0.8, kUp, 5 * kUp}};
  spreadWithinCones({Vec3(6, 0, 0)}, two);
  EXPECT_NEAR(two[0].impulse.x(), 0, 1e-9);
  EXPECT_NEAR(two[1].impulse.x(), 6, 1e-9);
  EXPECT_NEAR(two[1].impulse.z(), 7.5, 1e-9) << "6 / 0.8";
  EXPECT_NEAR(two[0].impulse.z(), 2.5, 1e-9);
}

TEST(ConeBalance, WhatWasToldOutsideItsConeStays) {
  std::vector<SharedImpulse> one = {{0, -1, 1, 0.1, kUp, Vec3(3, 0, 4)},
                                    {0, -1, 1, 0.5, kUp, Vec3(0, 0, -2)}};
  const std::vector<SharedImpulse> told = one;
  spreadWithinCones({Vec3::Zero()}, one);
  for (int i = 0; i < 2; ++i) EXPECT_LT((one[i].impulse - told[i].impulse).norm(), 1e-12);
}

TEST(ConeBalance, SumIsRightWhereNoConeCanGiveIt) {
  std::vector<SharedImpulse> one = {{0, -1, 1, 0.5, kUp, 2 * kUp}};
  EXPECT_FALSE(spreadWithinCones({Vec3(9, 0, 1)}, one));
  EXPECT_LT((one[0].impulse - Vec3(9, 0, 3)).norm(), 1e-9);
}

/// By alternating projections onto balance and cones [Dykstra1983].
std::vector<SharedImpulse> nearest(const std::vector<SharedImpulse>& told,
                                   const std::vector<Vec3>& rest) {
  const int n = static_cast<int>(rest.size());
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(n, n);
  const auto sign = [](const SharedImpulse& s, int body) {
    return double(s.first == body) - double(s.second == body);
  };
  for (const SharedImpulse& s : told)
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k) laplacian(i, k) += s.weight * sign(s, i) * sign(s, k);
  const Eigen::MatrixXd inverse = laplacian.inverse();
  std::vector<Vec3> wanted = sumsOf(told, rest.size());
  for (int i = 0; i < n; ++i) wanted[i] += rest[i];
  std::vector<SharedImpulse> now = told;
  std::vector<Vec3> correction(told.size(), Vec3::Zero());
  for (int round = 0; round < 100000; ++round) {
    const std::vector<Vec3> sums = sumsOf(now, rest.size());
    Eigen::MatrixXd missing(n, 3);
    for (int i = 0; i < n; ++i) missing.row(i) = (wanted[i] - sums[i]).transpose();
    const Eigen::MatrixXd mu = inverse * missing;
    for (std::size_t c = 0; c < now.size(); ++c) {
      for (int i = 0; i < n; ++i)
        now[c].impulse += now[c].weight * sign(now[c], i) * mu.row(i).transpose();
      const Vec3 z = now[c].impulse + correction[c];
      const double normal = z.dot(now[c].normal), f = now[c].friction;
      const Vec3 tangent = z - normal * now[c].normal;
      const double slope = tangent.norm();
      if (f * slope <= -normal) {
        now[c].impulse.setZero();
      } else if (slope > f * normal) {
        const double on = (normal + f * slope) / (1 + f * f);
        now[c].impulse = on * (now[c].normal + f / slope * tangent);
      } else {
        now[c].impulse = z;
      }
      correction[c] = z - now[c].impulse;
    }
  }
  return now;
}

TEST(ConeBalance, IsTheNearestThatIsWithinTheCones) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0, 1);
  const auto direction = [&](double spread) {
    return Vec3(spread * (share(random) - 0.5), spread * (share(random) - 0.5), 1).normalized();
  };
  int bound = 0;
  for (int trial = 0; trial < 20; ++trial) {
    // Three bodies on the ground and on each other; what is wanted is what some impulses give.
    std::vector<SharedImpulse> told, given;
    const int pairs[][2] = {{0, -1}, {0, -1}, {1, -1}, {1, 0}, {2, 0}, {2, 1}, {2, 1}};
    for (const auto& pair : pairs) {
      SharedImpulse s{pair[0],        pair[1],     0.1 + share(random), 0.2 + 0.6 * share(random),
                      direction(1.5), Vec3::Zero()};
      const auto draw = [&] {
        const Vec3 across = s.normal.cross(direction(2)).normalized();
        return Vec3(10 * share(random) * (s.normal + s.friction * share(random) * across));
      };
      s.impulse = draw();
      told.push_back(s);
      s.impulse = draw();
      given.push_back(s);
    }
    std::vector<Vec3> rest = sumsOf(given, 3), had = sumsOf(told, 3);
    for (int i = 0; i < 3; ++i) rest[i] -= had[i];
    std::vector<SharedImpulse> spread = told;
    spreadWithinCones(rest, spread);
    const std::vector<SharedImpulse> expected = nearest(told, rest);
    const std::vector<Vec3> sums = sumsOf(spread, 3), wanted = sumsOf(given, 3);
    for (int i = 0; i < 3; ++i) EXPECT_LT((sums[i] - wanted[i]).norm(), 1e-10) << trial;
    for (std::size_t c = 0; c < told.size(); ++c) {
      EXPECT_LT(outside(spread[c]), 1e-9) << trial << " " << c;
      EXPECT_LT((spread[c].impulse - expected[c].impulse).norm(), 1e-6) << trial << " " << c;
      bound += outside(spread[c]) > -1e-9;
    }
  }
  EXPECT_GT(bound, 20) << "no cone is met";
}

}  // namespace
}  // namespace ragdoll
