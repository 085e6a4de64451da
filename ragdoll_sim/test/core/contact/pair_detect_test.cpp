#include "core/contact/pair_detect.h"

#include <gtest/gtest.h>

#include <numeric>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kRadius = 0.1;

/// A stick along x, and one along y that crosses it in the middle, `height` above.
Scene crossed(double height) {
  Scene scene = sceneOf(oneStick(1, 1, kRadius));
  scene.ragdoll_collision = true;
  scene.ragdolls.push_back(scene.ragdolls[0]);
  RagdollSpec& other = scene.ragdolls[1];
  other.name = "other";
  other.pose = {Vec3(0.5, -0.5, height), Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitZ()))};
  return scene;
}

std::vector<Contact> contactsOf(const World& world, PairSearch search) {
  PairDetector detector;
  std::vector<Contact> contacts;
  detector.appendBetween(world.model, world.state, world.state.x, world.state.x, search, contacts);
  return contacts;
}

TEST(PairDetect, FindsWhereSticksCross) {
  const World world(crossed(0.25));
  const std::vector<Contact> found = contactsOf(world, PairSearch::touches(0.1));
  ASSERT_EQ(found.size(), 1u);
  const Contact& c = found[0];
  EXPECT_EQ(c.ragdoll, 0);
  EXPECT_EQ(c.other, 1);
  EXPECT_NEAR(c.gap_start, 0.05, 1e-12);
  EXPECT_NEAR(c.offset, 2 * kRadius, 1e-12);
  EXPECT_LT((c.normal + Vec3::UnitZ()).norm(), 1e-12);  // out of the second
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(c.weight[k], k < 2 ? 0.5 : -0.5, 1e-9);
  EXPECT_TRUE(contactsOf(world, PairSearch::touches(0.01)).empty());
}

TEST(PairDetect, LeavesOutThoseOfOneGroup) {
  const World world(crossed(0.15));
  PairDetector detector;
  std::vector<Contact> found;
  const PairSearch search = PairSearch::overlaps(0.01);
  const std::vector<int> apart = {0, 1}, together = {1, 1};
  const Points& x = world.state.x;
  detector.appendBetween(world.model, world.state, x, x, search, found, &apart);
  EXPECT_EQ(found.size(), 1u);
  found.clear();
  detector.appendBetween(world.model, world.state, x, x, search, found, &together);
  EXPECT_TRUE(found.empty());
}

TEST(PairDetect, LeavesSleepersToEachOther) {
  World world(crossed(0.15));
  EXPECT_EQ(contactsOf(world, PairSearch::overlaps(0.01)).size(), 1u);
  world.state.asleep = {1, 0};
  ASSERT_EQ(contactsOf(world, PairSearch::overlaps(0.01)).size(), 1u);
  EXPECT_FALSE(contactsOf(world, PairSearch::overlaps(0.01))[0].moves[0]);
  world.state.asleep = {1, 1};
  EXPECT_TRUE(contactsOf(world, PairSearch::overlaps(0.01)).empty());
}

}  // namespace
}  // namespace ragdoll
