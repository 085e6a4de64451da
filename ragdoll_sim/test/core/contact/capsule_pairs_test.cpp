// Closest points of two sticks with known answers, tapered radii against a search, sweeps.
#include "core/contact/capsule_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace ragdoll {
namespace {

CapsuleAxis axis(const Vec3& a, const Vec3& b, double ra = 0, double rb = 0) {
  return {a, b, ra, rb};
}

TEST(ClosestPoints, KnownAnswers) {
  struct Case {
    CapsuleAxis first, second;
    double s, t, distance;
  };
  const Case cases[] = {
      // crossing at right angles, 1 apart
      {axis({-1, 0, 1}, {1, 0, 1}), axis({0, -1, 0}, {0, 3, 0}), 0.5, 0.25, 1},
      // both closest at ends
      {axis({0, 0, 0}, {1, 0, 0}), axis({2, 1, 0}, {3, 5, 0}), 1, 0, std::sqrt(2.0)},
      // an end against an inside
      {axis({0, 0, 0}, {0, 0, 4}), axis({1, 0, 1}, {9, 0, 1}), 0.25, 0, 1},
      // the lines cross beyond an end of the second, which decides for the first
      {axis({0, 0, 0}, {4, 0, 0}), axis({1, 1, 0}, {3, 2, 0}), 0.25, 0, 1},
      // a point against a stick, a stick against a point, two points
      {axis({1, 1, 0}, {1, 1, 0}), axis({0, 0, 0}, {4, 0, 0}), 0, 0.25, 1},
      {axis({0, 0, 0}, {4, 0, 0}), axis({3, -2, 0}, {3, -2, 0}), 0.75, 0, 2},
      {axis({1, 2, 3}, {1, 2, 3}), axis({1, 2, 5}, {1, 2, 5}), 0, 0, 2},
      // intersecting
      {axis({-1, 0, 0}, {1, 0, 0}), axis({0.5, -1, 0}, {0.5, 1, 0}), 0.75, 0.5, 0},
  };
  for (const Case& c : cases) {
    const AxisPoints at = closestPoints(c.first, c.second);
    EXPECT_NEAR(at.s, c.s, 1e-12);
    EXPECT_NEAR(at.t, c.t, 1e-12);
    EXPECT_NEAR(gapAt(c.first, c.second, at), c.distance, 1e-12);
  }
}

TEST(ClosestPoints, OfParallelSticksAreAsFarApartAsTheSticks) {
  const CapsuleAxis a = axis({0, 0, 0}, {2, 0, 0}), b = axis({3, 0.5, 0}, {1, 0.5, 0});
  EXPECT_NEAR(gapAt(a, b, closestPoints(a, b)), 0.5, 1e-12);
}

TEST(NearestPoints, OfTaperedCapsulesMatchASearch) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  constexpr int kGrid = 200;
  for (int i = 0; i < 200; ++i) {
    const CapsuleAxis a = axis(point(), point(), 0.02, 0.2), b = axis(point(), point(), 0.15, 0.01);
    double best = 1e9;
    for (int s = 0; s <= kGrid; ++s)
      for (int t = 0; t <= kGrid; ++t)
        best = std::min(best, gapAt(a, b, {1.0 * s / kGrid, 1.0 * t / kGrid}));
    EXPECT_LE(gapAt(a, b, nearestPoints(a, b)), best + 2e-4) << i;
  }
}

/// The gap is convex: where no place near by is nearer, none is.
TEST(NearestPoints, HaveNoPlaceNearByThatIsNearer) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  const auto radius = [&] { return 0.3 * std::abs(unit(random)); };
  for (int i = 0; i < 4000; ++i) {
    CapsuleAxis a = axis(point(), point(), radius(), radius());
    CapsuleAxis b = axis(point(), point(), radius(), radius());
    if (i % 4 == 1) b.b = b.a + (a.b - a.a) + 0.01 * point();  // almost parallel
    if (i % 4 == 2) a.b = a.a + 0.05 * point();                // one end may hold the other
    if (i % 4 == 3) b.b = b.a;
    const AxisPoints at = nearestPoints(a, b);
    const double gap = gapAt(a, b, at);
    for (int k = 0; k < 20; ++k) {
      const double size = std::pow(10.0, -1 - 6 * std::abs(unit(random)));
      const AxisPoints near{std::clamp(at.s + size * unit(random), 0.0, 1.0),
                            std::clamp(at.t + size * unit(random), 0.0, 1.0)};
      ASSERT_LE(gap, gapAt(a, b, near) + 1e-14) << i;
    }
  }
}

/// Two crossed sticks, the second moving along z to the first from 1 m below.
int touchesAt(double travel, double margin, std::array<CapsuleTouch, 2>& touches) {
  const SweptCapsule first{{-1, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {1, 0, 0}, 0.05, 0.05};
  const Vec3 up(0, 0, travel);
  const Vec3 a(0.5, -1, -1), b(0.5, 1, -1);
  const SweptCapsule second{a, b, a + up, b + up, 0.05, 0.05};
  return findTouches(first, second, margin, touches);
}

TEST(Touches, AreFoundOnTheWayAtAnySpeed) {
  for (const double travel : {0.95, 1.0, 2.0, 100.0, 1e6}) {
    std::array<CapsuleTouch, 2> touches;
    ASSERT_EQ(touchesAt(travel, 0, touches), 1) << travel;
    EXPECT_NEAR((touches[0].normal - Vec3::UnitZ()).norm(), 0, 1e-9) << travel;
    EXPECT_NEAR(touches[0].at.s, 0.75, 1e-9);
    EXPECT_NEAR(touches[0].gap_start, 0.9, 1e-12);
    EXPECT_NEAR(touches[0].radii, 0.1, 1e-12);
  }
}

TEST(Touches, OfPairsThatStayApartAreNone) {
  std::array<CapsuleTouch, 2> touches;
  EXPECT_EQ(touchesAt(0.5, 0.01, touches), 0);
  EXPECT_EQ(touchesAt(-0.5, 0.01, touches), 0);
  EXPECT_EQ(touchesAt(0, 0.89, touches), 0);
  EXPECT_EQ(touchesAt(0, 0.91, touches), 1);
}

TEST(Touches, OfParallelCapsulesAreTheEndsOfTheirOverlap) {
  std::array<CapsuleTouch, 2> touches;
  const SweptCapsule a{{0, 0, 0}, {2, 0, 0}, {0, 0, 0}, {2, 0, 0}, 0.1, 0.1};
  const SweptCapsule b{{1, 0, 0.2}, {3, 0, 0.2}, {1, 0, 0.2}, {3, 0, 0.2}, 0.1, 0.1};
  ASSERT_EQ(findTouches(a, b, 0.01, touches), 2);
  EXPECT_NEAR(touches[0].at.s, 0.5, 1e-12);
  EXPECT_NEAR(touches[0].at.t, 0, 1e-12);
  EXPECT_NEAR(touches[1].at.s, 1, 1e-12);
  EXPECT_NEAR(touches[1].at.t, 0.5, 1e-12);
}

TEST(Touches, OfAxesThatCrossAtASmallAngleIncludeTheCrossing) {
  const double tilt = 0.1;  // rad; a distance of 0.05 at the crossing is one of 0.15 at the ends
  const SweptCapsule a{{-1, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {1, 0, 0}, 0.05, 0.05};
  const Vec3 along(std::cos(tilt), std::sin(tilt), 0), up(0, 0, 0.05);
  const SweptCapsule b{up - along, up + along, up - along, up + along, 0.05, 0.05};
  std::array<CapsuleTouch, 2> touches;
  ASSERT_EQ(findTouches(a, b, 0.01, touches), 2);
  const auto gap = [&](int k) { return gapAt(a.at(1), b.at(1), touches[k].at); };
  EXPECT_NEAR(std::min(gap(0), gap(1)), -0.05, 1e-12);
}

/// The first lies along x; the second, across it, slides on it from x = -0.5 to 0.5, where it ends
/// `depth` deep.
int overlapsAt(double depth, double least, std::array<CapsuleTouch, 2>& touches) {
  const SweptCapsule first{{-1, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {1, 0, 0}, 0.05, 0.05};
  const SweptCapsule second{
      {-0.5, -1, -0.1}, {-0.5, 1, -0.1}, {0.5, -1, depth - 0.1}, {0.5, 1, depth - 0.1}, 0.05, 0.05};
  return findOverlaps(first, second, least, touches);
}

TEST(Overlaps, AreFoundWhereCapsulesThatTouchedHaveSlidTo) {
  std::array<CapsuleTouch, 2> touches;
  EXPECT_EQ(overlapsAt(0.009, 0.01, touches), 0);
  for (const double depth : {0.011, 0.05, 0.09}) {
    ASSERT_EQ(overlapsAt(depth, 0.01, touches), 1) << depth;
    EXPECT_NEAR(touches[0].at.s, 0.75, 1e-9) << depth;
    EXPECT_NEAR((touches[0].normal - Vec3::UnitZ()).norm(), 0, 1e-9) << depth;
    EXPECT_NEAR(touches[0].gap_start, 0, 1e-12);
  }
}

TEST(Overlaps, OfAxesThatHaveCrossedPushBackTheWayTheyCame) {
  std::array<CapsuleTouch, 2> touches;
  ASSERT_EQ(overlapsAt(0.15, 0.01, touches), 1);
  EXPECT_NEAR((touches[0].normal - Vec3::UnitZ()).norm(), 0, 1e-9);
}

}  // namespace
}  // namespace ragdoll
