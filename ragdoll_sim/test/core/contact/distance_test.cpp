#include "core/contact/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/contact/detect.h"
#include "support/obstacles.h"

namespace ragdoll {
namespace {

using namespace test;
using Type = ObstacleSpec::Type;

TEST(Distance, KnownAnswers) {
  const Obstacle box = obstacle(Type::kBox, Vec3(1, 2, 3), 0);
  EXPECT_DOUBLE_EQ(signedDistance(box, Vec3(4, 0, 0)).value, 3);
  EXPECT_DOUBLE_EQ(signedDistance(box, Vec3(4, 6, 3)).value, 5);
  EXPECT_DOUBLE_EQ(signedDistance(box, Vec3(0.8, 0, 0)).value, -0.2);
  EXPECT_EQ(signedDistance(box, Vec3(0, -1.9, 0)).normal, Vec3(0, -1, 0));
  const Obstacle sphere = obstacle(Type::kSphere, Vec3::Zero(), 2);
  EXPECT_DOUBLE_EQ(signedDistance(sphere, Vec3(0, 3, 4)).value, 3);
  const Obstacle capsule = obstacle(Type::kCapsule, Vec3(0, 0, 1), 0.5);
  EXPECT_DOUBLE_EQ(signedDistance(capsule, Vec3(2, 0, 0.7)).value, 1.5);
  EXPECT_DOUBLE_EQ(signedDistance(capsule, Vec3(0, 3, 5)).value, 4.5);
}

TEST(Distance, ValueAgreesAndNormalIsItsGradient) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-4, 4);
  for (const Obstacle& o :
       {obstacle(Type::kPlane, Vec3::Zero(), 0), obstacle(Type::kBox, Vec3(1, 2, 0.5), 0),
        obstacle(Type::kSphere, Vec3::Zero(), 1), obstacle(Type::kCapsule, Vec3(0, 0, 1), 0.5)}) {
    for (int i = 0; i < 200; ++i) {
      const Vec3 p(uniform(random), uniform(random), uniform(random));
      const Distance d = signedDistance(o, p);
      EXPECT_NEAR(d.value, signedDistanceValue(o, p), 1e-14);
      Vec3 gradient;
      for (int k = 0; k < 3; ++k)
        gradient[k] = (signedDistanceValue(o, p + 1e-6 * Vec3::Unit(k)) -
                       signedDistanceValue(o, p - 1e-6 * Vec3::Unit(k))) /
                      2e-6;
      EXPECT_LT((gradient - d.normal).norm(), 1e-5);
    }
  }
}

TEST(Distance, CentresAndSurfacesHaveANormal) {
  EXPECT_EQ(signedDistance(obstacle(Type::kSphere, Vec3::Zero(), 1), Vec3::Zero()).normal.norm(),
            1);
  EXPECT_EQ(signedDistance(obstacle(Type::kBox, Vec3::Ones(), 0), Vec3(1, 0, 0)).normal,
            Vec3::UnitX());
}

TEST(Distance, NormalOnACapsulesAxisLeadsOut) {
  const Obstacle capsule = obstacle(Type::kCapsule, Vec3(0, 0, 1), 0.5);
  for (const double z : {0.0, 0.7, -1.0, 1.0}) {
    const Distance d = signedDistance(capsule, Vec3(0, 0, z));
    EXPECT_DOUBLE_EQ(d.value, -0.5);
    EXPECT_NEAR(signedDistanceValue(capsule, Vec3(0, 0, z) + 0.5 * d.normal), 0, 1e-15);
  }
}

TEST(Distance, OfAStickIsItsNearestPlaces) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5), thickness(0.01, 0.3);
  constexpr int kPlaces = 2000;
  for (const Obstacle& o :
       {obstacle(Type::kPlane, Vec3::Zero(), 0), obstacle(Type::kBox, Vec3(0.5, 0.8, 0.2), 0),
        obstacle(Type::kSphere, Vec3::Zero(), 0.5), obstacle(Type::kCapsule, Vec3(0, 0, 1), 0.2)}) {
    for (int i = 0; i < 500; ++i) {
      Vec3 a(uniform(random), uniform(random), uniform(random));
      Vec3 b(uniform(random), uniform(random), uniform(random));
      if (i % 5 == 0) b.z() = a.z();               // along a face
      if (i % 7 == 0) a.y() = b.y() = o.half.y();  // in a face
      if (i % 11 == 0) b = -a;                     // through the middle
      const double ra = thickness(random), rb = i % 3 == 0 ? ra : thickness(random);
      double least = 1e9;
      for (int k = 0; k <= kPlaces; ++k) {
        const double t = static_cast<double>(k) / kPlaces;
        least = std::min(least, signedDistanceValue(o, a + t * (b - a)) - ra - t * (rb - ra));
      }
      const double gap = stickGap(o, a, b, ra, rb);
      EXPECT_LE(gap, least + 1e-7);
      EXPECT_GE(gap, least - ((b - a).norm() + std::abs(rb - ra)) / kPlaces);
    }
  }
}

}  // namespace
}  // namespace ragdoll
