#include "ragdoll_sim/core/start_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(StartState, TellsTheEnergyThatPinsTake) {
  Scene scene = sceneOf(oneStick(1, 1));
  scene.ragdolls[0].velocity = Vec3(0, 3, 0);
  scene.pins = {pinOf("a")};
  double taken = 0;
  const State state = startState(buildModel(scene), &taken);
  EXPECT_EQ(Vec3(state.v.col(0)), Vec3::Zero());
  EXPECT_NEAR(state.v(1, 1), 3, 1e-12);  // its own mass goes on
  EXPECT_NEAR(taken, 4.5, 1e-12);
  EXPECT_THAT(takenText(taken), testing::HasSubstr("4.5 J"));
  EXPECT_EQ(takenText(0), "");
}

}  // namespace
}  // namespace ragdoll
