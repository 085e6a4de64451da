#include "core/direct/mode_pairs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/mode_body.h"

namespace ragdoll {
namespace {

using namespace test;

/// Two rods of 1 m, a on b, that taper.
struct Rods : ModeBody {
  ModeRow row;

  explicit Rods(bool stick = true, bool other_stick = true) : ModeBody(scene()) {
    row.kind = ModeRow::Kind::kPair;
    row.other = 1;
    row.b = stick ? 1 : 0;
    row.d = other_stick ? 1 : 0;
    row.ra = 0.05;
    row.rb = stick ? 0.08 : 0.05;
    row.rc = 0.06;
    row.rd = other_stick ? 0.03 : 0.06;
  }
  static Scene scene() {
    Scene scene = modeScene(oneStick(1, 1, 0.05), Vec3(0, 0, 9), floorPlane());
    scene.ragdolls.push_back(scene.ragdolls[0]);
    scene.ragdolls[1].name = "other";
    scene.ragdolls[1].pose.position = Vec3(0, 0, 5);
    scene.ragdoll_collision = true;
    return scene;
  }
  /// The island's coordinates from those of a, b, c, d.
  RowValues values(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    RowValues x;
    x.setZero(mode().size);
    x.segment<3>(0) = a;
    x.segment<3>(3) = b;
    x.segment<3>(mode().offset[1]) = c;
    x.segment<3>(mode().offset[1] + 3) = d;
    return x;
  }
};

const Vec3 kA(-0.4, 0.1, 0.2), kB(0.6, -0.1, 0.15), kC(0.1, -0.5, 0), kD(0.15, 0.5, 0.02);
const Vec3 kVa(1, 2, -1), kVb(-2, 1, 0.5), kVc(0.3, -1, 1), kVd(1, 1, -2);

/// Along a motion without accelerations: gap'' by central differences of the gap.
TEST(ModePairs, GapCurvesAsItsNearestPlacesMove) {
  for (const bool stick : {false, true})
    for (const bool other : {false, true}) {
      Rods rods(stick, other);
      if (!stick) rods.row.kind = ModeRow::Kind::kPair;
      const RowValues x =
          rods.values(stick ? kA : Vec3(0.12, 0, 0.2), kB, other ? kC : Vec3(0.1, 0.02, 0), kD);
      const RowValues v = rods.values(kVa, kVb, kVc, kVd);
      const auto gapAt = [&](double t) {
        RowValues there;
        there = x + t * v;
        return gapOf(rods.island, rods.row, there.data());
      };
      const RowPlace place = placeOf(rods.island, rods.row, x.data(), v.data(), true);
      EXPECT_TRUE(place.inside && place.regular);
      const double e = 1e-4;
      EXPECT_NEAR(rateOf(rods.island, rods.row, place, v.data()), (gapAt(e) - gapAt(-e)) / (2 * e),
                  1e-5);
      EXPECT_NEAR(place.curvature, (gapAt(e) - 2 * gapAt(0) + gapAt(-e)) / (e * e), 1e-4)
          << stick << other;
    }
}

/// What slips: the rate between the places, which move along the sticks.
TEST(ModePairs, SlipTurnsAsTheNearestPlacesMove) {
  Rods rods;
  const RowValues x = rods.values(kA, kB, kC, kD), v = rods.values(kVa, kVb, kVc, kVd);
  const auto rateAt = [&](double t) {
    RowValues there;
    there = x + t * v;
    const RowPlace place = placeOf(rods.island, rods.row, there.data(), v.data(), false);
    return motionOf(rods.island, place.contact, v.data());
  };
  const RowPlace place = placeOf(rods.island, rods.row, x.data(), v.data(), true);
  const double e = 1e-5;
  EXPECT_LT((place.turn - (rateAt(e) - rateAt(-e)) / (2 * e)).norm(), 1e-6);
}

TEST(ModePairs, EndsAndSticksAlongEachOtherAreForTheEndsRows) {
  Rods rods;
  const auto placeAt = [&](const Vec3& a, const Vec3& b) {
    const RowValues x = rods.values(a, b, Vec3(0, -0.5, 0), Vec3(0, 0.5, 0));
    return placeOf(rods.island, rods.row, x.data(), x.data(), false);
  };
  EXPECT_TRUE(placeAt(Vec3(-0.5, 0, 0.2), Vec3(0.5, 0, 0.2)).inside);
  EXPECT_FALSE(placeAt(Vec3(0.1, 0, 0.2), Vec3(1.1, 0, 0.2)).inside);
  rods.row.rb = rods.row.ra;
  rods.row.rd = rods.row.rc;
  EXPECT_TRUE(placeAt(Vec3(-0.5, 0, 0.2), Vec3(0.5, 0, 0.2)).regular);
  EXPECT_FALSE(placeAt(Vec3(0, -0.5, 0.2), Vec3(0, 0.5, 0.2)).regular);
}

/// Each end against each end and against the other stick, and stick against stick.
TEST(ModePairs, AreNinePerPairOfSticksWithinReach) {
  Scene scene = Rods::scene();
  scene.obstacles.clear();
  scene.ragdolls[1].pose.position = scene.ragdolls[0].pose.position + Vec3(0, 0, 0.2);
  scene.solver.step = 1;
  EXPECT_EQ(ModeBody(scene).mode().rows.size(), 9u);
  scene.ragdolls[1].pose.position += Vec3(0, 0, 1000);
  EXPECT_EQ(ModeBody(scene).mode().rows.size(), 0u);
}

}  // namespace
}  // namespace ragdoll
