#include "core/fast/lane_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/contact/detect.h"
#include "core/contact/distance.h"

namespace ragdoll {
namespace {

/// A box, a capsule and a sphere.
std::vector<Obstacle> solids() {
  std::vector<Obstacle> all(3);
  all[0].type = ObstacleSpec::Type::kBox;
  all[0].half = Vec3(0.3, 0.2, 0.1);
  all[1].type = ObstacleSpec::Type::kCapsule;
  all[1].half = Vec3(0, 0, 0.4);
  all[1].radius = 0.1;
  all[2].type = ObstacleSpec::Type::kSphere;
  all[2].radius = 0.25;
  return all;
}

fast::Solid solidOf(const Obstacle& o) {
  fast::Solid solid;
  std::copy_n(o.half.data(), 3, solid.half);
  solid.radius = o.radius;
  return solid;
}

tree::V3<double> of(const Vec3& a) { return {a.x(), a.y(), a.z()}; }

class LaneDistance : public testing::Test {
 protected:
  Vec3 place() { return {unit_(random_), unit_(random_), unit_(random_)}; }

 private:
  std::mt19937 random_{3};
  std::uniform_real_distribution<double> unit_{-0.6, 0.6};
};

TEST_F(LaneDistance, OfAParticleIsTheSignedDistance) {
  for (const Obstacle& o : solids())
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = place();
      const fast::Way<double> way = fast::wayTo(of(p), solidOf(o));
      const Distance exact = signedDistance(o, p);
      EXPECT_NEAR(way.distance - o.radius, exact.value, 1e-12);
      EXPECT_NEAR(way.normal.x, exact.normal.x(), 1e-9);
      EXPECT_NEAR(way.normal.y, exact.normal.y(), 1e-9);
      EXPECT_NEAR(way.normal.z, exact.normal.z(), 1e-9);
    }
}

/// [m] Most by which a stick's gap is larger than its least, where its axis is outside.
double worst(const Obstacle& o, double taper, const Vec3& a, const Vec3& b) {
  const auto axis = fast::stickAxis(of(a), of(b), 0.05, 0.05 + taper);
  const fast::NearestPlace<double> n = fast::nearestPlace(axis, solidOf(o));
  const double least = stickGap(o, a, b, 0.05, 0.05 + taper);
  EXPECT_GE(n.at, 0);
  EXPECT_LE(n.at, 1);
  if (least < -0.01) return 0;
  const double gap = n.distance - o.radius - (0.05 + taper * n.at);
  EXPECT_GT(gap, least - 1e-9);
  return gap - least;
}

TEST_F(LaneDistance, OfAStickIsWhereItsGapIsLeast) {
  for (const Obstacle& o : solids())
    for (int i = 0; i < 5000; ++i) EXPECT_LT(worst(o, 0, place(), place()), 1e-9);
}

/// Where a stick is half as thick again at its other end, the place is off by what costs a few mm
/// at most.
TEST_F(LaneDistance, OfATaperedStickIsAllButThat) {
  for (const Obstacle& o : solids())
    for (int i = 0; i < 5000; ++i)
      EXPECT_LT(worst(o, i % 2 == 0 ? 0.03 : -0.03, place(), place()), 3e-3);
}

/// Flat on a face, or along an edge: anywhere on it.
TEST_F(LaneDistance, OfAStickThatLiesFlatIsOnIt) {
  const Obstacle box = solids()[0];
  EXPECT_LT(worst(box, 0, Vec3(-0.5, 0, 0.14), Vec3(0.5, 0, 0.14)), 1e-12);
  EXPECT_LT(worst(box, 0, Vec3(0.35, -0.5, 0), Vec3(0.35, 0.5, 0)), 1e-12);
  EXPECT_LT(worst(box, 0, Vec3(-0.5, 0.23, 0.13), Vec3(0.5, 0.23, 0.13)), 1e-12);
}

}  // namespace
}  // namespace ragdoll
