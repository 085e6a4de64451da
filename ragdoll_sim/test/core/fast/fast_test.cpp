#include "core/fast/fast.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/step/workspace.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// So many rods in a row, 2 m apart.
Scene rods(int count) {
  Scene scene = sceneOf(oneStick(1, 1, 0.1), Vec3(0, 0, 0.1));
  const RagdollSpec rod = scene.ragdolls[0];
  scene.ragdolls.clear();
  for (int i = 0; i < count; ++i) {
    scene.ragdolls.push_back(rod);
    scene.ragdolls[i].name = "rod" + std::to_string(i);
    scene.ragdolls[i].pose.position.y() = 2 * i;
  }
  scene.obstacles = {floorPlane(0.5)};
  scene.solver.method = Method::kFast;
  return scene;
}

TEST(Batches, HaveEveryBodyThatIsAwakeOnce) {
  for (const int lanes : {0, 1, 4}) {
    World world(rods(11));
    FastScratch& scratch = world.workspace.impl().fast;
    scratch.most_lanes = lanes;
    world.state.asleep[3] = 1;
    EXPECT_EQ(world.steps(1).fast_fallbacks, 0);
    EXPECT_EQ(scratch.order, (std::vector<int>{0, 1, 2, 4, 5, 6, 7, 8, 9, 10}));
    int next = 0;
    for (const fast::Batch& batch : scratch.batches) {
      EXPECT_EQ(batch.begin, next);
      EXPECT_LE(batch.count, lanes > 0 ? lanes : fast::kMaxLanes);
      next += batch.count;
    }
    EXPECT_EQ(next, 10);
  }
}

TEST(Batches, KeepWhatEachParticlePressedWith) {
  World world(rods(3));
  EXPECT_EQ(world.steps(2).contacts, 6);
  ASSERT_EQ(world.state.impulses.size(), 6u);
  for (int k = 0; k < 6; ++k) {
    const CachedImpulse& last = world.state.impulses[k];
    EXPECT_EQ(last.ragdoll, k / 2);
    EXPECT_EQ(last.a, k);  // two particles of each rod
    EXPECT_EQ(last.b, -1);
    EXPECT_EQ(last.obstacle, 0);
    EXPECT_LT((last.impulse - 0.5 * Vec3(0, 0, 9.81)).norm(), 1e-9);  // half of the force
  }
}

/// A rod that lies with its middle across a bar.
TEST(Batches, KeepWhatAStickPressedWith) {
  Scene scene = rods(1);
  ObstacleSpec bar;
  bar.type = ObstacleSpec::Type::kCapsule;
  bar.from = Vec3(0.5, -1, 0);
  bar.to = Vec3(0.5, 1, 0);
  bar.radius = 0.2;
  scene.obstacles = {bar};
  scene.ragdolls[0].pose.position.z() = 0.3;
  World world(scene);
  world.steps(2);
  ASSERT_EQ(world.state.impulses.size(), 1u);
  EXPECT_EQ(world.state.impulses[0].a, 0);
  EXPECT_EQ(world.state.impulses[0].b, 1);
  EXPECT_LT((world.state.impulses[0].impulse - Vec3(0, 0, 9.81)).norm(), 1e-9);  // half of 2 kg
  EXPECT_NEAR(world.x(0).z(), 0.3, 1e-12);
}

/// A ball that lies between two others, which hold it at 30 degrees from the vertical; sweeps over
/// both end before the last thousandth.
TEST(Batches, KeepWhatOneParticlePressedWithOnEachObstacle) {
  Scene scene = rods(1);
  scene.ragdolls[0].skeleton = std::make_shared<const SkeletonSpec>(oneParticle(2, 0.1));
  scene.ragdolls[0].pose.position = Vec3::Zero();
  scene.obstacles.clear();
  const double angle = M_PI / 6;
  for (const int side : {-1, 1}) {
    ObstacleSpec ball;
    ball.type = ObstacleSpec::Type::kSphere;
    ball.radius = 0.4;
    ball.friction = 0;
    ball.pose.position = 0.5 * Vec3(side * std::sin(angle), 0, -std::cos(angle));
    scene.obstacles.push_back(ball);
  }
  World world(scene);
  world.steps(2);
  ASSERT_EQ(world.state.impulses.size(), 2u);
  const double press = 0.5 * 2 * 9.81 / (2 * std::cos(angle));  // half of the force
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(world.state.impulses[k].obstacle, k);
    EXPECT_NEAR(world.state.impulses[k].impulse.norm(), press, 2e-3 * press);
  }
}

}  // namespace
}  // namespace ragdoll
