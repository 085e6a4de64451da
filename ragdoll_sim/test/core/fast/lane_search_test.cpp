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

}  // namespace
}  // namespace ragdoll::fast
