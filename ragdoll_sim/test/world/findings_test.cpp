// What is said of a state: masses, contacts of sleepers, overlaps.
#include "ragdoll_sim/core/findings.h"

#include <gtest/gtest.h>

#include <string>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/world/world.h"

namespace {

using ragdoll::Vec3;
using ragdoll::World;

/// Until all sleep.
void rest(World& world) {
  const auto awake = [&] {
    for (const auto a : world.state().asleep)
      if (!a) return true;
    return false;
  };
  for (int i = 0; i < 20000 && awake(); ++i) world.advance();
  ASSERT_FALSE(awake());
}

TEST(PointMasses, addUpToTheMassAndTheMomentum) {
  for (const char* model : {"human", "human_lumped", "human_thesis"}) {
    World world(ragdoll::parseScene(
        std::string("gravity: [0, 0, 0]\nragdolls: [{model: ") + model +
            ", position: [0, 0, 1], velocity: [1, 2, 3], angular_velocity: [1, 0, 2]}]\n",
        "scene"));
    for (int i = 0; i < 50; ++i) world.advance();
    const ragdoll::Model& m = *world.model();
    const ragdoll::Skeleton& s = m.skeletons[0];
    const Eigen::VectorXd masses = pointMasses(s);
    EXPECT_NEAR(masses.sum(), 75, 0.01) << model;
    EXPECT_NEAR(masses.sum(), s.M.sum(), 1e-9) << model;
    const Vec3 p = world.state().v.leftCols(s.named) * masses;
    const Vec3 c = world.state().x.leftCols(s.named) * masses / masses.sum();
    // Exact but for the pelvis of `human`, whose centre of mass is 8 mm off its plane.
    EXPECT_LT((c - centreOfMass(m, world.state(), 0)).norm(), 1e-3) << model;
    EXPECT_LT((p - momentum(m, world.state())).norm(), 1e-3 * p.norm()) << model;
    if (std::string(model) != "human") {
      EXPECT_LT((c - centreOfMass(m, world.state(), 0)).norm(), 1e-12) << model;
    }
  }
}

TEST(Sleepers, touchAsTheyDidBeforeTheySlept) {
  for (const char* scene : {"fall", "stairs", "two"}) {
    World world(ragdoll::loadScene(scene));
    EXPECT_EQ(contactsOfSleepers(*world.model(), world.state()), 0);
    rest(world);
    // What pressed still touches; beside it is what touches without a force.
    const int touching = contactsOfSleepers(*world.model(), world.state());
    EXPECT_GE(touching, world.report().contacts) << scene;
    EXPECT_LE(touching, world.report().contacts + 4) << scene;
  }
}

TEST(Overlaps, areNamedWhileTheyLast) {
  World world(ragdoll::parseScene(R"(
ragdolls: [{name: anna, model: human, position: [0, 0, 0.16], rpy_deg: [0, 90, 0]}]
obstacles:
  - {type: plane}
  - {name: beam, type: box, position: [0.7, 0, 0.1], size: [0.1, 2, 0.2]}
)",
                                  "scene"));
  const auto start = deepOverlaps(*world.model(), world.state());
  ASSERT_EQ(start.size(), 1u);
  EXPECT_EQ(start[0].find("anna is "), 0u) << start[0];
  EXPECT_NE(start[0].find(" cm inside beam"), std::string::npos) << start[0];
  World apart(ragdoll::loadScene("fall"));
  rest(apart);
  EXPECT_TRUE(deepOverlaps(*apart.model(), apart.state()).empty());
}

}  // namespace
