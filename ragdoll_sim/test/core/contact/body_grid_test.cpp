// The broad phase finds what brute force finds, in the same order, at a cost that grows linearly.
#include "core/contact/body_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace ragdoll {
namespace {

using BodyPairs = std::vector<std::pair<int, int>>;

BodyPairs bruteForce(const std::vector<Bounds>& boxes) {
  BodyPairs pairs;
  for (int i = 0; i < static_cast<int>(boxes.size()); ++i)
    for (int j = i + 1; j < static_cast<int>(boxes.size()); ++j)
      if (overlap(boxes[i], boxes[j])) pairs.emplace_back(i, j);
  return pairs;
}

/// n boxes of 0.2 ... 2 m in a square that grows with n: always as dense.
std::vector<Bounds> crowd(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const double side = 1.5 * std::sqrt(n);
  std::vector<Bounds> boxes;
  for (int i = 0; i < n; ++i) {
    const Vec3 lo(side * (unit(random) - 0.5), side * (unit(random) - 0.5), unit(random));
    boxes.push_back({lo, lo + Vec3(0.2 + 1.8 * unit(random), 0.2 + 1.8 * unit(random), 1.8)});
  }
  return boxes;
}

TEST(BodyGrid, FindsTheSamePairsAsBruteForceInRandomCrowds) {
  BodyGrid grid;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<Bounds> boxes = crowd(100 + 20 * seed, seed);
    EXPECT_EQ(grid.findPairs(boxes), bruteForce(boxes)) << "seed " << seed;
    EXPECT_FALSE(grid.findPairs(boxes).empty());
  }
}

TEST(BodyGrid, FindsPairsOfFastFarAndHugeBoxes) {
  std::vector<Bounds> boxes = crowd(50, 3);
  boxes[10].hi += Vec3(300, 300, 300);                       // swept far
  boxes[20] = {Vec3::Constant(1e12), Vec3::Constant(2e12)};  // far away, and near each other
  boxes[21] = {Vec3::Constant(1.5e12), Vec3::Constant(3e12)};
  boxes[30].lo.x() = boxes[30].hi.x() = std::numeric_limits<double>::quiet_NaN();
  BodyGrid grid;
  EXPECT_EQ(grid.findPairs(boxes), bruteForce(boxes));
}

TEST(BodyGrid, ComparesInProportionToTheNumberOfBoxes) {
  BodyGrid grid;
  const auto perBox = [&](int n) {
    grid.findPairs(crowd(n, 1));
    return static_cast<double>(grid.compared()) / n;
  };
  const double few = perBox(100), many = perBox(10000);
  EXPECT_LT(many, 1.3 * few);
  EXPECT_LT(many, 60);
}

}  // namespace
}  // namespace ragdoll
