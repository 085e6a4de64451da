#include "core/direct/impact_energy.h"

#include <gtest/gtest.h>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// Three balls, of which an impact pressed the first and the last on each other.
struct PressedBalls : DirectIsland {
  PressedBalls() : DirectIsland(scene()) {}

  static Scene scene() {
    Scene scene = weightless(oneParticle(2, 0.1));
    scene.ragdolls.resize(3, scene.ragdolls[0]);
    for (int k = 0; k < 3; ++k) {
      scene.ragdolls[k].name = "ball" + std::to_string(k);
      scene.ragdolls[k].pose.position.x() = k;
    }
    return scene;
  }
  double gain(const std::vector<double>& before, const std::vector<double>& after) {
    return impactGain(island, {island.bodies[0], island.bodies[2]}, before,
                      [&](const Body& body) { return after[body.index]; });
  }
};

TEST(ImpactEnergy, IsThatOfThoseThatWerePressedOnEachOther) {
  PressedBalls balls;
  EXPECT_EQ(balls.gain({1, 2, 1}, {0.5, 0, 3}), 1.5);
}

TEST(ImpactEnergy, OfALossOrOfRoundingIsNone) {
  PressedBalls balls;
  EXPECT_EQ(balls.gain({1, 2, 1}, {0.5, 8, 1}), 0);
  EXPECT_EQ(balls.gain({1, 2, 1}, {1 + 1e-9, 2, 1}), 0);
}

}  // namespace
}  // namespace ragdoll
