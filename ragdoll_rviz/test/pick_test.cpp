#include "pick.h"

#include <gtest/gtest.h>

namespace ragdoll_rviz {
namespace {

using Eigen::Vector3d;

geometry_msgs::Point point(double x, double y, double z) {
  geometry_msgs::Point p;
  p.x = x, p.y = y, p.z = z;
  return p;
}

ragdoll_msgs::Stick stick(const std::string& name, int a, int b) {
  ragdoll_msgs::Stick s;
  s.name = name;
  s.a = static_cast<std::uint16_t>(a);
  s.b = static_cast<std::uint16_t>(b);
  return s;
}

/// A forearm of 1 m along x at z = 1, a torso's stick of 1 m along y at z = 0, a ball at x = 5.
struct World {
  ragdoll_msgs::Model model;
  ragdoll_msgs::State state;

  World() {
    model.ragdolls.resize(1);
    state.ragdolls.resize(1);
    model.ragdolls[0].name = state.ragdolls[0].name = "anna";
    model.ragdolls[0].particles = {"elbow", "hand", "hip", "neck", "ball"};
    model.ragdolls[0].sticks = {stick("forearm", 0, 1), stick("hip-neck", 2, 3)};
    state.ragdolls[0].positions = {point(0, 0, 1), point(1, 0, 1), point(0.5, -0.5, 0),
                                   point(0.5, 0.5, 0), point(5, 0, 0)};
  }
  std::optional<Hit> look(const Vector3d& from, const Vector3d& direction) const {
    return pick({from, direction.normalized()}, model, state);
  }
};

TEST(Pick, ABoneIsMetWhereTheRayPassesIt) {
  const auto hit = World().look({0.8, 0, 4}, {0, 0, -1});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->body_name, "anna/forearm");
  EXPECT_LT((hit->offset - Vector3d(0.3, 0, 0)).norm(), 1e-12);  // from its middle
  EXPECT_NEAR(hit->depth, 3, 1e-12);
}

TEST(Pick, ASlantedRayHitsWhereItIsClosest) {
  // Passes the forearm 0.05 m beside its point x = 0.25.
  const Vector3d direction = Vector3d(1, 0, -1).normalized();
  const Vector3d aim(0.25, 0.05, 1);
  const auto hit = World().look(aim - 2 * direction, direction);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->body_name, "anna/forearm");
  EXPECT_LT((hit->offset - Vector3d(-0.25, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(hit->depth, 2, 1e-12);
}

TEST(Pick, TheNearestIsMet) {
  // Where forearm and torso cross; from above and from below.
  EXPECT_EQ(World().look({0.5, 0, 4}, {0, 0, -1})->body_name, "anna/forearm");
  EXPECT_EQ(World().look({0.5, 0.1, -4}, {0, 0, 1})->body_name, "anna/neck");
}

TEST(Pick, WhatIsNoBoneIsMetAtItsNearerParticle) {
  const auto hit = World().look({4, -0.4, 0}, {-1, 0, 0});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->body_name, "anna/hip");
  EXPECT_EQ(hit->offset, Vector3d::Zero());
  EXPECT_EQ(World().look({5, 0, 9}, {0, 0, -1})->body_name, "anna/ball");
}

TEST(Pick, ALimbIsPreferredToATrunkThatIsFarFromTheRay) {
  // 0.1 m beside the torso's stick, which is nearer, and through the forearm behind it.
  EXPECT_EQ(World().look({0.6, 0, -4}, {0, 0, 1})->body_name, "anna/forearm");
  EXPECT_EQ(World().look({0.6, 0.3, -4}, {0, 0, 1})->body_name, "anna/neck");
}

TEST(Pick, MissesWhatIsBesideOrBehind) {
  EXPECT_FALSE(World().look({2, 2, 4}, {0, 0, -1}));
  EXPECT_FALSE(World().look({0.2, 0, 4}, {0, 0, 1}));
  EXPECT_FALSE(World().look({-1, 0, 1}, {-1, 0, 0}));
  EXPECT_TRUE(World().look({-1, 0, 1}, {1, 0, 0}));  // along the bone
}

TEST(Pick, AStateOfAnotherModelIsNotMet) {
  World world;
  world.state.ragdolls[0].positions.pop_back();
  EXPECT_FALSE(world.look({0.8, 0, 4}, {0, 0, -1}));
  world = World();
  world.state.ragdolls[0].name = "ben";
  EXPECT_FALSE(world.look({0.8, 0, 4}, {0, 0, -1}));
  world = World();
  world.model.ragdolls[0].sticks[0].b = 99;
  EXPECT_EQ(world.look({0.98, 0, 4}, {0, 0, -1})->body_name, "anna/hand");
}

}  // namespace
}  // namespace ragdoll_rviz
