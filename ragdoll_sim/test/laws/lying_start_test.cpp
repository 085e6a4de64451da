// A body that begins on its back on a floor with a foot where the joints do not allow it: the first
// steps draw it in, through the floor.
#include <gtest/gtest.h>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// A foot placed 90 degrees past the limit of the knee: more than steps put right. On the floor it
/// may stay there: so do 2 of 3 such bodies whose foot is some mm beside.
const Vec3 kPastTheKnee(0.4964, -0.0864, 0.4776);

Scene lying(const Vec3& foot) {
  Scene scene = parseScene(R"(
ragdolls: [{model: human, position: [0, 0, 0.13], rpy_deg: [0, -90, 0]}]
obstacles: [{type: plane, friction: 0.6}]
)");
  scene.ragdolls[0].place = {{"right_foot", foot}};
  return scene;
}

TEST(LyingStart, RigidStepsDoNotSinkIn) {
  Scene scene = lying(kPastTheKnee);
  scene.solver.method = Method::kJakobsen;  // the others draw the foot in with joints alive
  World world(scene);
  ASSERT_EQ(maxPenetration(world.model, world.state), 0);
  int rigid = 0;
  for (int i = 0; i < 600; ++i) {
    rigid += world.steps(1).rigid;
    ASSERT_LT(maxPenetration(world.model, world.state), 5e-4) << "at " << world.state.time << " s";
  }
  EXPECT_GT(rigid, 0);  // or the scene does not show what it is for
}

TEST(LyingStart, WhatOverlapsOneFloorComesOutAndTheJointsWithIt) {
  for (const Vec3& foot :
       {kPastTheKnee, Vec3(0.4964, -0.0864, 0.6076), Vec3(0.1584, -0.1546, 0.4504)}) {
    World world(lying(foot));
    const double recovery = 2 * world.model.solver.step;  // [m] at 2 m/s
    double deep = maxPenetration(world.model, world.state), fastest = 0;
    for (int i = 0; i < 240; ++i) {
      world.steps(1);
      const double before = deep;
      deep = maxPenetration(world.model, world.state);
      fastest = std::max(fastest, before - deep);
    }
    EXPECT_LT(fastest, recovery + 1e-4) << foot.transpose();
    EXPECT_LT(maxPenetration(world.model, world.state), 1e-5) << foot.transpose();
    if (foot != kPastTheKnee) {
      EXPECT_LT(maxLimitViolation(world.model, world.state), 1e-3) << foot.transpose();
    }
    EXPECT_LT(maxStickError(world.model, world.state), 1e-6) << foot.transpose();
  }
}

}  // namespace
}  // namespace ragdoll
