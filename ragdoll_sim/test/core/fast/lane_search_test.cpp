#include "core/fast/lane_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace ragdoll::fast {
namespace {

/// A box, a capsule and a sphere.
std::vector<Solid> solids() {
  std::vector<Solid> all(3);
  std::copy_n(std::vector<double>{0.3, 0.2, 0.1}.data(), 3, all[0].half);
  all[1].half[2] = 0.4;
  all[1].radius = 0.1;
  all[2].radius = 0.25;
  return all;
}

class LaneSearch : public testing::Test {
 protected:
  V3<double> place() { return {unit_(random_), unit_(random_), unit_(random_)}; }

  /// However a path was found at one time, it is at no time nearer to the solid than `apart`.
  template <class Path>
  void keepsApart(const Solid& o, const Path& path) {
    for (const double found : {0.0, 0.5, 1.0}) {
      const Touch<double> touch = path.at(o, found);
      if (touch.distance < 1e-3) continue;
      const double apart = path.apart(o, touch);
      EXPECT_LE(apart, touch.gap + 1e-9);
      if (apart < 0) continue;
      ++apart_;
      for (int k = 0; k <= 20; ++k) EXPECT_GE(path.at(o, 0.05 * k).gap, apart - 1e-9);
    }
  }

  int apart_ = 0;

 private:
  std::mt19937 random_{5};
  std::uniform_real_distribution<double> unit_{-0.8, 0.8};
};

TEST_F(LaneSearch, APlaneKeepsParticlesApartAllTheWay) {
  for (const Solid& o : solids())
    for (int i = 0; i < 1000; ++i) keepsApart(o, ParticlePath<double>{place(), place(), 0.05});
  EXPECT_GT(apart_, 1000);
}

TEST_F(LaneSearch, APlaneKeepsSticksApartAllTheWay) {
  for (const Solid& o : solids())
    for (int i = 0; i < 1000; ++i)
      keepsApart(o, StickPath<double>{place(), place(), place(), place(), 0.04, 0.06});
  EXPECT_GT(apart_, 300);
}

/// A stick comes near where the box about both ends' ways, with their radii, meets the bound.
TEST_F(LaneSearch, SticksComeNearWhereTheBoundsOfBothEndsDo) {
  const V3<double> bound{0.1, 0.05, 0.15};
  Feature stick;
  stick.a = 0;
  stick.b = 1;
  int near = 0;
  for (int i = 0; i < 2000; ++i) {
    const V3<double> at[4] = {place(), place(), place(), place()};
    const Reach reach[2] = {reachOf(at[0], at[1], 0.05, bound), reachOf(at[2], at[3], 0.1, bound)};
    const auto meets = [&](double V3<double>::*c) {
      const double a[2] = {at[0].*c, at[1].*c}, b[2] = {at[2].*c, at[3].*c};
      const auto wide = std::minmax({a[0] - 0.05, a[1] - 0.05, a[0] + 0.05, a[1] + 0.05, b[0] - 0.1,
                                     b[1] - 0.1, b[0] + 0.1, b[1] + 0.1});
      return wide.first < bound.*c && wide.second > -(bound.*c);
    };
    const bool expected = meets(&V3<double>::x) && meets(&V3<double>::y) && meets(&V3<double>::z);
    EXPECT_EQ(comesNear(stick, reach), expected ? 1u : 0u);
    near += expected;
  }
  EXPECT_GT(near, 100);
  EXPECT_LT(near, 1900);
}

/// A batch has each pair's own numbers, and no more pairs than there are.
TEST_F(LaneSearch, BatchesTakePairsOfAnyLane) {
  using Two = LaneWork<double, 2, 7>;
  Pack<double, 2> at[6];
  for (int i = 0; i < 6; ++i) at[i].v = Pack<double, 2>::Vector{1.0 * i, 10.0 * i};
  const NearPair pairs[] = {{0, 1}, {1, 0}, {1, 1}};
  SolidPlace<Pack<double, 2>> s{};
  s.at1.x.v = Pack<double, 2>::Vector{3, 4};
  Pack<double, 2> margin;
  margin.v = Pack<double, 2>::Vector{0.1, 0.2};
  const auto particle = [](const NearPair& p) { return p.feature; };
  const auto full = batchOf<Two>(pairs, 3, margin, s);
  EXPECT_EQ(lanesOf(full.mask), 3u);
  EXPECT_EQ(lane(full.ofParticles(at, particle).y, 0), 10);  // particle 0 in lane 1
  EXPECT_EQ(lane(full.ofParticles(at, particle).y, 1), 4);   // particle 1 in lane 0
  EXPECT_EQ(lane(full.margin, 0), 0.2);
  EXPECT_EQ(lane(full.at1.x, 1), 3);
  const auto rest = batchOf<Two>(pairs + 2, 1, margin, s);
  EXPECT_EQ(lanesOf(rest.mask), 1u);
  EXPECT_EQ(lane(rest.ofParticles(at, particle).x, 0), 30);
}

}  // namespace
}  // namespace ragdoll::fast
