#include "core/contact/detect.h"

#include <gtest/gtest.h>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kMargin = 0.02;

std::vector<Contact> contactsOf(const Scene& scene, const Vec3& motion) {
  const World world(scene);
  const Points end = world.state.x.colwise() + motion;
  std::vector<SweptObstacle> obstacles;
  std::vector<Contact> contacts;
  findContacts(world.model, world.state, end, {}, kMargin, obstacles, contacts);
  return contacts;
}

ObstacleSpec boxOf(const Vec3& size, const Vec3& at) {
  ObstacleSpec o;
  o.type = ObstacleSpec::Type::kBox;
  o.size = size;
  o.pose.position = at;
  return o;
}

TEST(Detect, FindsABallNearAFloor) {
  Scene scene = sceneOf(oneParticle(1, 0.1), Vec3(0, 0, 0.105));
  scene.obstacles = {floorPlane()};
  const std::vector<Contact> near = contactsOf(scene, Vec3::Zero());
  ASSERT_EQ(near.size(), 1u);
  EXPECT_NEAR(near[0].gap_start, 0.005, 1e-15);
  EXPECT_EQ(near[0].normal, Vec3::UnitZ());
  EXPECT_NEAR(near[0].offset, 0.1, 1e-15);  // where its centre may go down to
  scene.ragdolls[0].pose.position.z() = 0.2;
  EXPECT_TRUE(contactsOf(scene, Vec3::Zero()).empty());
}

TEST(Detect, FindsWhatABallPassesThrough) {
  Scene scene = sceneOf(oneParticle(1, 0.01), Vec3(0, 0, 5));
  scene.obstacles = {boxOf(Vec3(4, 4, 0.02), Vec3::Zero())};
  const std::vector<Contact> hit = contactsOf(scene, Vec3(0.3, 0, -10));
  ASSERT_EQ(hit.size(), 1u);
  EXPECT_LT((hit[0].normal - Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_NEAR(hit[0].offset, 0.02, 1e-12);
}

/// A ball that rests on a sphere and goes along it by more than half its radius has the plane of its
/// end; one that is pushed into the sphere by as much that of its start.
TEST(Detect, WhatRestsGoesAlongHoweverFar) {
  Scene scene = sceneOf(oneParticle(1, 0.02), Vec3(0, 0, 0.52));
  ObstacleSpec sphere;
  sphere.type = ObstacleSpec::Type::kSphere;
  sphere.radius = 0.5;
  scene.obstacles = {sphere};
  for (const Vec3& motion : {Vec3(0.1, 0, -0.012), Vec3(0.1, 0, -0.05)}) {
    const std::vector<Contact> on = contactsOf(scene, motion);
    ASSERT_EQ(on.size(), 1u);
    const bool along = motion.z() > -0.02;
    const Vec3 at = Vec3(0, 0, 0.52) + (along ? motion : Vec3::Zero());
    EXPECT_LT((on[0].normal - at.normalized()).norm(), 1e-12);
    EXPECT_TRUE(on[0].touches_at_start);
    EXPECT_EQ(on[0].start_normal, Vec3::UnitZ());
  }
}

TEST(Detect, AStickLiesOnABoxAtBothEdges) {
  Scene scene = sceneOf(oneStick(1, 1, 0.02), Vec3(0, 0, 0.125));
  scene.obstacles = {boxOf(Vec3(0.2, 4, 0.2), Vec3(0.5, 0, 0))};
  const std::vector<Contact> lies = contactsOf(scene, Vec3::Zero());
  ASSERT_EQ(lies.size(), 2u);
  for (const Contact& c : lies) {
    EXPECT_EQ(c.count, 2);
    EXPECT_NEAR(c.gap_start, 0.005, 1e-12);
  }
  EXPECT_NEAR(lies[0].weight[1], 0.4, 0.01);
  EXPECT_NEAR(lies[1].weight[1], 0.6, 0.01);
}

}  // namespace
}  // namespace ragdoll
