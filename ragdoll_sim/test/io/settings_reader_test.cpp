// Settings of a file, and on top of a scene: applySetting.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/error_of.h"

namespace ragdoll {
namespace {

using test::errorOf;
using ::testing::HasSubstr;

Scene anyScene() { return parseScene("ragdolls: [{model: human}]\n", "scene"); }

TEST(Settings, EachSetsItsOwnOfAFileAndOfAScene) {
  struct Case {
    const char *key, *value;
    std::function<bool(const Scene&)> is_set;
  };
  const Case cases[] = {
      {"solver.preset", "thesis", [](const Scene& s) { return s.solver.preset == "thesis"; }},
      {"solver.method", "rk", [](const Scene& s) { return s.solver.method == Method::kRk; }},
      {"solver.integrator", "midpoint",
       [](const Scene& s) { return s.solver.integrator == Integrator::kMidpoint; }},
      {"solver.step", "0.001", [](const Scene& s) { return s.solver.step == 0.001; }},
      {"solver.sweeps", "7", [](const Scene& s) { return s.solver.sweeps == 7; }},
      {"solver.tolerance", "1e-5", [](const Scene& s) { return s.solver.tolerance == 1e-5; }},
      {"solver.events", "true", [](const Scene& s) { return s.solver.events; }},
      {"solver.damping", "0.5", [](const Scene& s) { return s.solver.damping == 0.5; }},
      {"solver.joint_damping", "3", [](const Scene& s) { return s.solver.joint_damping == 3; }},
      {"solver.sleep", "false", [](const Scene& s) { return !s.solver.sleep; }},
      {"solver.numbers", "float",
       [](const Scene& s) { return s.solver.numbers == Numbers::kFloat; }},
      {"solver.threads", "2", [](const Scene& s) { return s.solver.threads == 2; }},
      {"gravity", "[0, 0, -1.62]", [](const Scene& s) { return s.gravity == Vec3(0, 0, -1.62); }},
      {"self_collision", "true", [](const Scene& s) { return s.self_collision; }},
      {"ragdoll_collision", "true", [](const Scene& s) { return s.ragdoll_collision; }},
      {"coat", "boxes", [](const Scene& s) { return s.coat == "boxes"; }}};
  const std::string section = "solver.";
  for (const Case& c : cases) {
    Scene scene = anyScene();
    EXPECT_FALSE(c.is_set(scene)) << c.key;
    applySetting(scene, c.key, c.value);
    EXPECT_TRUE(c.is_set(scene)) << c.key;
    EXPECT_TRUE(c.is_set(parseScene(scene.text))) << c.key;  // its text says so, too
    const std::string key = c.key, line = std::string(": ") + c.value;
    const bool of_solver = key.compare(0, section.size(), section) == 0;
    const Scene read = parseScene(
        "ragdolls: [{model: human}]\n" +
        (of_solver ? "solver: {" + key.substr(section.size()) + line + "}\n" : key + line + "\n"));
    EXPECT_TRUE(c.is_set(read)) << c.key;
    EXPECT_EQ(read.text, scene.text) << c.key;
  }
}

TEST(Settings, ThatCannotBeSayWhatCouldAndChangeNothing) {
  Scene scene = anyScene();
  const std::string before = scene.text;
  const auto refusal = [&](const char* key, const char* value) {
    return errorOf([&] { applySetting(scene, key, value); });
  };
  EXPECT_THAT(refusal("solver.method", "magic"), HasSubstr("jakobsen"));
  EXPECT_THAT(refusal("solver.numbers", "half"), HasSubstr("double"));
  EXPECT_THAT(refusal("solver.step", "1.1"), HasSubstr("from 1e-07 to 1"));
  EXPECT_THAT(refusal("solver.sweeps", "0"), HasSubstr("from 1 to 100000"));
  EXPECT_THAT(refusal("solver.threads", "257"), HasSubstr("from 0 to 256"));
  EXPECT_THAT(refusal("solver.damping", "-1"), HasSubstr("0 or a positive number"));
  EXPECT_THAT(refusal("coat", "fur"), HasSubstr("skin"));
  EXPECT_THAT(refusal("step", "0.01"), HasSubstr("solver.step"));  // not without its section
  EXPECT_THAT(refusal("solver.coat", "skin"), HasSubstr("unknown"));
  EXPECT_EQ(scene.text, before);
}

TEST(Settings, APresetReplacesAllKnobs) {
  Scene scene = anyScene();
  applySetting(scene, "solver.step", "0.001");
  applySetting(scene, "solver.preset", "thesis");
  EXPECT_EQ(scene.solver.step, 1.0 / 60);
}

TEST(Settings, APresetLeavesTheDampingOfTheJointsAsItIs) {
  Scene scene = parseScene(
      "ragdolls: [{model: human}]\nsolver: {preset: draft, damping: 0.5, joint_damping: 2}\n",
      "scene");
  applySetting(scene, "solver.preset", "precise");
  EXPECT_EQ(scene.solver.preset, "precise");
  EXPECT_EQ(scene.solver.step, preset("precise").step);
  EXPECT_EQ(scene.solver.damping, 0);  // it is the preset's
  EXPECT_EQ(scene.solver.joint_damping, 2);
  EXPECT_EQ(parseScene(scene.text, "text").solver.joint_damping, 2);
}

TEST(Settings, PresetFirstThenKnobsWhateverTheirOrder) {
  const Scene scene =
      parseScene("ragdolls: [{model: human}]\nsolver: {sweeps: 3, preset: thesis}\n");
  EXPECT_EQ(scene.solver.preset, "thesis");
  EXPECT_EQ(scene.solver.sweeps, 3);
  EXPECT_EQ(scene.solver.step, 1.0 / 60);
  EXPECT_EQ(parseScene("ragdolls: [{model: human}]").solver.preset, "balanced");
  const SolverSpec knobs =
      parseScene(
          "ragdolls: [{model: human}]\nsolver: {method: rk, integrator: euler, "
          "step: 0.5, sweeps: 2, damping: 3, preset: thesis}\n")
          .solver;
  EXPECT_EQ(knobs.method, Method::kRk);
  EXPECT_EQ(knobs.integrator, Integrator::kEuler);
  EXPECT_EQ(knobs.step, 0.5);
  EXPECT_EQ(knobs.damping, 3);
}

TEST(Settings, AToleranceThatRoundingMissesIsRefusedWithItsPlace) {
  for (const char* bad : {"-1.0e-3", "1.0e-13", ".inf", ".nan"}) {
    const std::string text =
        std::string("ragdolls: [{model: human}]\nsolver:\n  method: rk\n  tolerance: ") + bad +
        "\n";
    const std::string error = errorOf([&] { parseScene(text, "my.yaml"); });
    EXPECT_NE(error.find("my.yaml:4"), std::string::npos) << error;
    EXPECT_NE(error.find("tolerance"), std::string::npos) << error;
  }
  Scene scene = anyScene();
  EXPECT_NE(errorOf([&] { applySetting(scene, "solver.tolerance", "1e-13"); }), "");
  EXPECT_EQ(scene.solver.tolerance, 0);
  applySetting(scene, "solver.tolerance", "1e-12");
  EXPECT_EQ(scene.solver.tolerance, 1e-12);
}

}  // namespace
}  // namespace ragdoll
