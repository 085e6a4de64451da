#include "core/contact/axis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/contact/constants.h"
#include "support/obstacles.h"

namespace ragdoll {
namespace {

using namespace test;
using Type = ObstacleSpec::Type;

const Obstacle kUnitBox = obstacle(Type::kBox, Vec3::Ones());

/// A tapered capsule touches a sphere where its cone does: beside the foot of the sphere's centre,
/// by the angle whose sine is the taper over the length.
TEST(Axis, IsNearestToASphereWhereItsConeIs) {
  const Obstacle sphere = obstacle(Type::kSphere, Vec3::Zero(), 0.5);
  const Vec3 a(-1, 0, 1), b(2, 0, 1);
  const double foot = 1.0 / 3, length = 3;
  for (const double taper : {0.0, 0.3, -0.6}) {
    const Axis axis{sphere, a, b, 0.7, 0.7 + taper};
    const double angle = std::asin(taper / length);
    EXPECT_NEAR(nearest(axis), foot + std::tan(angle) / length, 1e-14);
    EXPECT_NEAR(axis.gap(nearest(axis)), std::cos(angle) - axis.radius(foot) - 0.5, 1e-14);
  }
  EXPECT_EQ(nearest({sphere, a, b, 4, 0.5}), 0);  // a ball that has the other in it
  EXPECT_EQ(nearest({sphere, a, b, 0.5, 4}), 1);
}

/// Beyond its ends, too: of a sphere where its cone goes on, of a box beside the edge or corner
/// that it is asked for.
TEST(Axis, IsNearestToAFeatureAlsoBeyondItsEnds) {
  const Obstacle sphere = obstacle(Type::kSphere, Vec3::Zero(), 0.5);
  for (const double taper : {0.0, 0.3}) {
    const Axis axis{sphere, Vec3(1, 0, 1), Vec3(4, 0, 1), 0.1, 0.1 + taper};
    const double beside = std::tan(std::asin(taper / 3)) / 3;
    EXPECT_NEAR(nearestTo(axis, {0, 0, 0}, 1), -1.0 / 3 + beside, 1e-14);
    EXPECT_EQ(nearestTo(axis, {0, 0, 0}, 0.1), -0.1);
  }
  const Axis over{kUnitBox, Vec3(0, 0, 2.1), Vec3(1, 0.5, 1.1), 0.1, 0.1};
  EXPECT_NEAR(nearestTo(over, {1, 0, 1}, 1), 1.05, 1e-14);
  EXPECT_NEAR(nearestTo(over, {1, 1, 1}, 1), (1 + 0.5 + 1.1) / 2.25, 1e-14);
}

TEST(Axis, IsNearestToAPlaneAtItsLowerOrThickerEnd) {
  const Obstacle plane = obstacle(Type::kPlane, Vec3::Zero());
  const Vec3 low(0, 0, 1), high(1, 0, 1.2);
  EXPECT_EQ(nearest({plane, low, high, 0.1, 0.1}), 0);
  EXPECT_EQ(nearest({plane, high, low, 0.1, 0.1}), 1);
  EXPECT_EQ(nearest({plane, low, high, 0.1, 0.4}), 1);
}

/// To an edge of a box at the foot of the edge; where it goes through a plate half way through.
TEST(Axis, IsNearestToABoxAtAnEdgeOrInIt) {
  const Eigen::Vector2d from(0.8 - 1, 1.9 - 1), along(1.4, -1.1);
  const double foot = -from.dot(along) / along.squaredNorm();
  for (const double taper : {0.0, 0.2}) {
    const Axis past{kUnitBox, Vec3(0.8, -0.3, 1.9), Vec3(2.2, 0.4, 0.8), 0.05, 0.05 + taper};
    const double beside = (from + foot * along).norm(), angle = std::asin(taper / along.norm());
    EXPECT_NEAR(nearest(past), foot + beside * std::tan(angle) / along.norm(), 1e-14);
  }
  const Obstacle plate = obstacle(Type::kBox, Vec3(1, 1, 0.1));
  const Axis through{plate, Vec3(-0.3, 0, 0.5), Vec3(0.5, 0, -0.3), 0.05, 0.05};
  EXPECT_NEAR(nearest(through), 0.5 / 0.8, 1e-7);
}

TEST(Axis, LiesFlatOnAFaceUpToItsEdges) {
  const Axis axis{kUnitBox, Vec3(-1.5, 0.2, 1.05), Vec3(2.5, 0.2, 1.05), 0.05, 0.05};
  const double t = nearest(axis);
  EXPECT_NEAR(flatEnd(axis, t, 0), 0.5 / 4, 1e-14);
  EXPECT_NEAR(flatEnd(axis, t, 1), 2.5 / 4, 1e-14);
}

/// Also where it leans on one of them by less than 10 degrees, or tapers: all of it may come into
/// touch at once.
TEST(Axis, IsOverAFaceUpToItsEdgeWhereItLeans) {
  const Vec3 a(-1.5, 0, 1.05), b(0.5, 0, 1.05);
  const Axis leans{kUnitBox, a, b + 2 * std::tan(9 * M_PI / 180) * Vec3::UnitZ(), 0.05, 0.05};
  const Axis tapers{kUnitBox, a, b, 0.05, 0.01};
  for (const Axis* axis : {&leans, &tapers}) {
    const double t = nearest(*axis);
    EXPECT_LT(t, 0.3);
    EXPECT_EQ(flatEnd(*axis, t, 1), 1);
  }
  const Axis stands{kUnitBox, a, b + 2 * std::tan(11 * M_PI / 180) * Vec3::UnitZ(), 0.05, 0.05};
  const double t = nearest(stands);
  EXPECT_EQ(flatEnd(stands, t, 1), t);
}

/// Along an edge it does, up to the box's corners. Across an edge it does not.
TEST(Axis, LiesFlatAlongAnEdgeAndNotAcross) {
  const Axis along{kUnitBox, Vec3(1.1, -2, 1.1), Vec3(1.1, 2, 1.1), 0.05, 0.05};
  const double middle = 0.5;
  ASSERT_EQ(along.gap(middle), along.gap(nearest(along)));
  EXPECT_NEAR(flatEnd(along, middle, 0), 0.25, 1e-14);
  EXPECT_NEAR(flatEnd(along, middle, 1), 0.75, 1e-14);
  const Axis across{kUnitBox, Vec3(0.6, 0, 1.5), Vec3(1.5, 0, 0.6), 0.05, 0.05};
  EXPECT_NEAR(nearest(across), 0.5, 1e-14);
  EXPECT_EQ(flatEnd(across, 0.5, 0), 0.5);
  EXPECT_EQ(flatEnd(across, 0.5, 1), 0.5);
}

}  // namespace
}  // namespace ragdoll
