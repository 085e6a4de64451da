// Settings on top of a scene: applySetting.
#include <gtest/gtest.h>

#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace {

TEST(Settings, aPresetLeavesTheDampingOfTheJointsAsItIs) {
  ragdoll::Scene scene = ragdoll::parseScene(
      "ragdolls: [{model: human}]\nsolver: {preset: draft, damping: 0.5, joint_damping: 2}\n",
      "scene");
  applySetting(scene, "solver.preset", "precise");
  EXPECT_EQ(scene.solver.preset, "precise");
  EXPECT_EQ(scene.solver.step, ragdoll::preset("precise").step);
  EXPECT_EQ(scene.solver.damping, 0);  // it is the preset's
  EXPECT_EQ(scene.solver.joint_damping, 2);
  EXPECT_EQ(ragdoll::parseScene(scene.text, "text").solver.joint_damping, 2);
}

}  // namespace
