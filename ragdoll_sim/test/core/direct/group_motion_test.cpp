#include "core/direct/group_motion.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/direct_island.h"

namespace ragdoll::test {
namespace {

/// Balls of 1 and 3 kg, 4 m apart along x, of which the light one goes along y.
constexpr char kTwoBalls[] = R"(
gravity: [0, 0, 0]
ragdolls:
  - {name: a, position: [0, 0, 0], velocity: [0, 4, 0], model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.1}}}}
  - {name: b, position: [4, 0, 0], model: {particles: {p: {position: [0, 0, 0], mass: 3, radius: 0.1}}}}
)";

const auto kX = [](const Body& body) { return body.x(); };
const auto kV = [](const Body& body) { return body.v(); };

TEST(GroupMotion, DriftsWithTheCentreOfMass) {
  DirectIsland two(parseScene(kTwoBalls));
  const RigidMotion drift = driftOf(two.island.bodies, kX, kV);
  EXPECT_LT((drift.centre - Vec3(3, 0, 0)).norm(), 1e-14);
  EXPECT_LT((drift.drift - Vec3(0, 1, 0)).norm(), 1e-14);
}

TEST(GroupMotion, TurnsByTheReducedMass) {
  DirectIsland two(parseScene(kTwoBalls));
  const RigidMotion drift = driftOf(two.island.bodies, kX, kV);
  const Rotation all = rotationOf(two.island.bodies, drift, kX, kV);
  const double reduced = 0.75;  // [kg]
  EXPECT_LT((all.angular - Vec3(0, 0, -reduced * 4 * 4)).norm(), 1e-13);
  EXPECT_NEAR(all.inertia(2, 2), reduced * 4 * 4, 1e-13);
  EXPECT_NEAR(all.inertia(0, 0), 0, 1e-13);
}

TEST(GroupMotion, GroupsAreNumberedByTheirFirst) {
  DirectIsland two(parseScene(kTwoBalls));
  std::vector<int> group_of{0, 1};
  EXPECT_EQ(membersOf(two.island, group_of, 1).size(), 1u);
  joinGroups(1, 0, group_of);
  EXPECT_EQ(group_of, (std::vector<int>{0, 0}));
  EXPECT_EQ(membersOf(two.island, group_of, 0), two.island.bodies);
}

}  // namespace
}  // namespace ragdoll::test
