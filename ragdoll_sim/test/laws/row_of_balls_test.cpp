// Impacts that follow each other within a step: a row of balls at rest, of which the last is hit,
// hits the next, and so on, up to a wall. Against the closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "support/ends.h"
#include "support/samples.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

constexpr double kRadius = 0.05;

/// Balls in a row along z, above a wall at 0; each pushes on those below it.
struct BallRow {
  std::vector<double> z, v, mass;

  int size() const { return static_cast<int>(z.size()); }
  /// [m] Below a ball.
  double gap(int i) const { return z[i] - kRadius - (i > 0 ? z[i - 1] + kRadius : 0); }
  double approach(int i) const { return (i > 0 ? v[i - 1] : 0) - v[i]; }
  bool touches(int i) const { return gap(i) < 1e-12 && std::abs(approach(i)) < 1e-12; }
};

/// Which ball is the next to meet what is below it, and when; its size if none.
int nextImpact(const BallRow& row, double& time) {
  int which = row.size();
  for (int i = 0; i < row.size(); ++i) {
    if (!(row.approach(i) > 1e-12)) continue;
    const double at = std::max(0.0, row.gap(i)) / row.approach(i);
    if (which < row.size() && at >= time) continue;
    time = at;
    which = i;
  }
  return which;
}

/// All that touch go on as one.
void meet(BallRow& row, int i) {
  int first = i - 1, last = i;
  while (first >= 0 && row.touches(first)) --first;
  while (last + 1 < row.size() && row.touches(last + 1)) ++last;
  double mass = 0, momentum = 0;
  for (int k = std::max(0, first); k <= last; ++k) {
    mass += row.mass[k];
    momentum += row.mass[k] * row.v[k];
  }
  for (int k = std::max(0, first); k <= last; ++k) row.v[k] = first < 0 ? 0 : momentum / mass;
}

void move(BallRow& row, double time) {
  for (int i = 0; i < row.size(); ++i) row.z[i] += time * row.v[i];
}

BallRow endOfRow(BallRow row, double seconds) {
  for (double left = seconds;;) {
    double time = 0;
    const int which = nextImpact(row, time);
    if (which == row.size() || time > left) {
      move(row, left);
      return row;
    }
    move(row, time);
    left -= time;
    meet(row, which);
  }
}

/// At rest but for the last one.
BallRow randomRow(int balls, double speed, std::mt19937& random) {
  const auto uniform = [&] { return random() / 4294967296.0; };
  BallRow row;
  double top = 0;
  for (int i = 0; i < balls; ++i) {
    row.z.push_back(top + 0.012 * uniform() + kRadius);
    row.v.push_back(0);
    row.mass.push_back(std::pow(10, uniform() - 0.5));
    top = row.z.back() + kRadius;
  }
  row.v.back() = -speed;
  return row;
}

Scene sceneOfRow(const BallRow& row) {
  Scene scene;
  scene.ragdoll_collision = true;
  scene.gravity.setZero();
  scene.obstacles = {floorPlane()};
  for (int i = 0; i < row.size(); ++i) {
    scene.ragdolls.push_back(
        sceneOf(oneParticle(row.mass[i], kRadius), Vec3(0, 0, row.z[i])).ragdolls[0]);
    scene.ragdolls.back().name = "ball" + std::to_string(i);
    scene.ragdolls.back().velocity = Vec3(0, 0, row.v[i]);
  }
  return scene;
}

TEST(RowOfBalls, ImpactsWithinOneStepAreAllMet) {
  std::mt19937 random(1);
  const double seconds = 0.06;
  for (const double speed : {1.0, 8.0, 30.0})
    for (int k = 0; k < samples(60); ++k) {
      const BallRow row = randomRow(3 + k % 6, speed, random), exact = endOfRow(row, seconds);
      const Scene scene = sceneOfRow(row);
      const Points rk = endOfImpacts(scene, Method::kRk, 0.004, seconds);
      const Points shake = endOfImpacts(scene, Method::kShake, 0.004, seconds);
      for (int i = 0; i < row.size(); ++i) {
        ASSERT_NEAR(rk(2, i), exact.z[i], 1e-13) << speed << ' ' << k << ' ' << i;
        ASSERT_NEAR(shake(2, i), exact.z[i], 1e-10) << speed << ' ' << k << ' ' << i;
      }
    }
}

}  // namespace
}  // namespace ragdoll::test
