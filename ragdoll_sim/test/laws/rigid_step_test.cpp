// What the guard's last resort, a rigid motion, keeps when a body lies on something.
#include <gtest/gtest.h>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// A human on its back whose foot is placed 90 degrees past the knee's limit, with a shank a
/// quarter too long: more than steps put right while it lies on a floor.
TEST(RigidStep, WhatLiesDoesNotSinkIn) {
  World world(parseScene(R"(
ragdolls:
  - model: human
    position: [0, 0, 0.13]
    rpy_deg: [0, -90, 0]
    place: {right_foot: [0.4964, -0.0864, 0.4776]}
obstacles: [{type: plane, friction: 0.6}]
)"));
  int rigid = 0;
  double early = 0;  // [m] of the first second: what the start brings
  for (int i = 0; i < 600; ++i) {
    rigid += world.steps(1).rigid;
    const double deep = maxPenetration(world.model, world.state);
    if (i < 120) early = std::max(early, deep);
    ASSERT_LT(deep, early + 1e-4) << "at " << world.state.time << " s";
  }
  EXPECT_GT(rigid, 0);  // or the scene does not show what it is for
  RecordProperty("deepest_mm", std::to_string(1e3 * early));
}

}  // namespace
}  // namespace ragdoll
