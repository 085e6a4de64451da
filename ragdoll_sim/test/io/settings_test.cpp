// Settings on top of a scene: applySetting.
#include <gtest/gtest.h>

#include <string>

#include "ragdoll_sim/core/error.h"
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

TEST(Settings, aToleranceThatRoundingMissesIsRefusedWithItsPlace) {
  for (const char* bad : {"-1.0e-3", "1.0e-13", ".inf", ".nan"}) {
    try {
      ragdoll::parseScene(
          std::string("ragdolls: [{model: human}]\nsolver:\n  method: rk\n  tolerance: ") + bad +
              "\n",
          "my.yaml");
      FAIL() << bad;
    } catch (const ragdoll::Error& e) {
      EXPECT_NE(std::string(e.what()).find("my.yaml:4"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("tolerance"), std::string::npos) << e.what();
    }
  }
  ragdoll::Scene scene = ragdoll::parseScene("ragdolls: [{model: human}]\n", "scene");
  EXPECT_THROW(applySetting(scene, "solver.tolerance", "1e-13"), ragdoll::Error);
  EXPECT_EQ(scene.solver.tolerance, 0);
  applySetting(scene, "solver.tolerance", "1e-12");
  EXPECT_EQ(scene.solver.tolerance, 1e-12);
}

}  // namespace
