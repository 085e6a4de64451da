// Whatever is wrong in a scene, the user is told where (file, line, key), what, and what would be
// right.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "errors_of_text.h"

namespace ragdoll {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const char kRagdoll[] = "ragdolls: [{model: human}]\n";

std::string errorAfterRagdoll(const std::string& text) { return errorOfText(kRagdoll + text); }

TEST(SceneErrors, AcceptsTheSceneThatTheOthersBreak) {
  EXPECT_EQ(errorOfText(kRagdoll), "");
  EXPECT_EQ(errorAfterRagdoll("gravity: [0, 0, -1]\nobstacles:\n  - {type: plane}\n"), "");
}

TEST(SceneErrors, UnknownKeyListsTheKnown) {
  EXPECT_THAT(errorAfterRagdoll("gravitation: [0, 0, 1]\n"),
              AllOf(StartsWith("scene.yaml:2: gravitation: unknown key"), HasSubstr("gravity"),
                    HasSubstr("obstacles")));
  EXPECT_THAT(errorAfterRagdoll("obstacles:\n  - type: sphere\n    position: [0, 0, 0]\n"
                                "    radius: 1\n    size: [1, 1, 1]\n"),
              AllOf(StartsWith("scene.yaml:6: obstacles[0].size: unknown key"),
                    HasSubstr("name, position, radius, friction, restitution, frame")));
}

TEST(SceneErrors, WrongTypeSaysWhichIsRight) {
  EXPECT_THAT(errorAfterRagdoll("gravity: down\n"),
              StartsWith("scene.yaml:2: gravity: is 'down'; a list of 3 numbers is expected"));
  EXPECT_THAT(errorAfterRagdoll("gravity: [0, 0, fast]\n"),
              StartsWith("scene.yaml:2: gravity[2]: is 'fast'; a number is expected"));
  EXPECT_THAT(errorAfterRagdoll("gravity: [0, 0]\n"),
              StartsWith("scene.yaml:2: gravity: has 2 items; a list of 3 numbers is expected"));
  EXPECT_THAT(errorAfterRagdoll("gravity:\n"),
              StartsWith("scene.yaml:2: gravity: has no value; a list of 3 numbers"));
  EXPECT_THAT(errorAfterRagdoll("self_collision: yes\n"),
              StartsWith("scene.yaml:2: self_collision: is 'yes'; true or false is expected"));
  EXPECT_THAT(errorAfterRagdoll("obstacles: {type: plane}\n"),
              StartsWith("scene.yaml:2: obstacles: is a mapping; a list is expected"));
  EXPECT_THAT(errorAfterRagdoll("pins: [[ragdoll]]\n"),
              StartsWith("scene.yaml:2: pins[0]: is a list; a particle"));
  EXPECT_THAT(errorAfterRagdoll("solver: {sweeps: 2.5}\n"),
              StartsWith("scene.yaml:2: solver.sweeps: is '2.5'; a whole number from 1"));
  EXPECT_THAT(errorAfterRagdoll("solver: {step: 1ms}\n"),
              StartsWith("scene.yaml:2: solver.step: is '1ms'; a number is expected"));
}

TEST(SceneErrors, Sensors) {
  const auto error = [](const std::string& sensor) {
    return errorAfterRagdoll("sensors:\n  - {type: imu, " + sensor + "}\n");
  };
  EXPECT_EQ(error("name: a, segment: torso, rate: 60"), "");
  EXPECT_EQ(error("name: a, segment: ragdoll/left_forearm, rate: 120"), "");
  EXPECT_THAT(error("name: a, segment: trunk"),
              AllOf(StartsWith("scene.yaml:3: sensors[0].segment: unknown segment 'trunk'"),
                    HasSubstr("torso, pelvis, head")));
  EXPECT_THAT(error("name: a, segment: ben/torso"),
              AllOf(StartsWith("scene.yaml:3: sensors[0].segment: unknown ragdoll 'ben'"),
                    HasSubstr("there are ragdoll")));
  EXPECT_THAT(error("name: a, segment: torso, rate: 100"),
              AllOf(StartsWith("scene.yaml:3: sensors[0].rate: rate is 100 Hz"),
                    HasSubstr("it must be 120 Hz or a whole part of it (60, 40, ...)")));
  EXPECT_THAT(error("name: a, segment: torso, rate: -1"),
              StartsWith("scene.yaml:3: sensors[0].rate: is -1;"));
  EXPECT_THAT(error("name: a, segment: torso, rate: .inf"),
              StartsWith("scene.yaml:3: sensors[0].rate: is '.inf'"));
  EXPECT_THAT(error("name: a, segment: torso, noise: {accelerometer: -1}"),
              StartsWith("scene.yaml:3: sensors[0].noise.accelerometer: is -1;"));
  EXPECT_THAT(error("name: a, segment: torso, range: {gyroscope: 0}"),
              StartsWith("scene.yaml:3: sensors[0].range.gyroscope: is 0;"));
  EXPECT_THAT(error("name: a, segment: torso}\n  - {name: a, type: imu, segment: head"),
              StartsWith("scene.yaml:4: sensors[1].name: name 'ragdoll/a' is another sensor's"));
  EXPECT_THAT(error("name: a"), StartsWith("scene.yaml:3: sensors[0]: "));
  EXPECT_THAT(errorAfterRagdoll("sensors: [{name: a, type: gps, segment: torso}]\n"),
              AllOf(StartsWith("scene.yaml:2: sensors[0].type: is 'gps'"), HasSubstr("imu")));
}

TEST(SceneErrors, ObstaclesOfOneName) {
  EXPECT_EQ(errorAfterRagdoll("obstacles: [{type: plane, name: floor}, {type: plane}]\n"), "");
  EXPECT_THAT(errorAfterRagdoll("obstacles:\n  - {type: plane, name: floor}\n"
                                "  - {type: plane, name: floor}\n"),
              StartsWith("scene.yaml:4: obstacles[1].name: name 'floor' is another obstacle's"));
}

TEST(SceneErrors, NonFiniteNumber) {
  for (const char* bad : {".nan", "nan", "NaN", ".inf", "-.inf", "inf", "1e999", "-1e999"}) {
    EXPECT_THAT(errorAfterRagdoll("obstacles:\n  - type: sphere\n    position: [0, " +
                                  std::string(bad) + ", 0]\n    radius: 1\n"),
                StartsWith("scene.yaml:4: obstacles[0].position[1]: is '" + std::string(bad) +
                           "'; a finite number is expected"))
        << bad;
  }
}

/// What numbers cannot follow (core/bounds.h), each as {key, scene with @ for the number}.
TEST(SceneErrors, FartherOutThanNumbersReach) {
  const std::pair<std::string, std::string> cases[] = {
      {"ragdolls[0].position", "ragdolls: [{model: human, position: [0, @, 0]}]\n"},
      {"ragdolls[0].place.head", "ragdolls: [{model: human, place: {head: [0, 0, @]}}]\n"},
      {"obstacles[0].point",
       std::string(kRagdoll) + "obstacles: [{type: plane, point: [@, 0, 0]}]\n"},
      {"obstacles[0].position",
       std::string(kRagdoll) + "obstacles: [{type: box, position: [@, 0, 0], size: [1, 1, 1]}]\n"},
      {"obstacles[0].size",
       std::string(kRagdoll) + "obstacles: [{type: box, position: [0, 0, 0], size: [1, @, 1]}]\n"},
      {"obstacles[0].radius",
       std::string(kRagdoll) + "obstacles: [{type: sphere, position: [0, 0, -10], radius: @}]\n"},
      {"obstacles[0].from", std::string(kRagdoll) + "obstacles: [{type: capsule, from: [@, 0, 9], "
                                                    "to: [0, 0, 9], radius: 1}]\n"},
      {"obstacles[0].to", std::string(kRagdoll) +
                              "obstacles: [{type: capsule, from: [0, 0, 9], to: "
                              "[0, 0, @], radius: 1}]\n"},
  };
  for (const auto& [key, scene] : cases) {
    const auto with = [&, at = scene.find('@')](const std::string& number) {
      return errorOfText(std::string(scene).replace(at, 1, number));
    };
    EXPECT_EQ(with("1e9"), "") << key;
    for (const std::string number : {"1.1e+09", "1e+160"})
      EXPECT_THAT(with(number), AllOf(StartsWith("scene.yaml:"), HasSubstr(" " + key + ": is "),
                                      HasSubstr(number), HasSubstr("to 1e+09")));
    EXPECT_NE(with("-1.1e9"), "") << key;
  }
  EXPECT_THAT(
      errorOfText("ragdolls: [{name: a, model: human, count: 9, spacing: [1e9, 0, 0]}]\n"),
      AllOf(StartsWith("scene.yaml:1: ragdolls[0].spacing: puts 'a_2' at [2e+09, 0, 0] m")));
}

TEST(SceneErrors, FasterThanNumbersCanFollow) {
  const auto with = [](const std::string& key, const std::string& vector) {
    return errorOfText("ragdolls: [{model: human, " + key + ": " + vector + "}]\n");
  };
  EXPECT_EQ(with("velocity", "[0, 1e10, 0]"), "");
  EXPECT_EQ(with("angular_velocity", "[0, 0, 1e10]"), "");  // no particle is 1 m from the axis
  EXPECT_THAT(with("velocity", "[0, 1.1e10, 0]"),
              AllOf(StartsWith("scene.yaml:1: ragdolls[0].velocity: makes 1.1e+10 m/s"),
                    HasSubstr("at most 1e+10")));
  EXPECT_THAT(with("angular_velocity", "[1e300, 0, 0]"),
              AllOf(StartsWith("scene.yaml:1: ragdolls[0].angular_velocity: makes "),
                    HasSubstr("at most 1e+10")));
  // 1/120 s, so that 1.2e12 m/s^2 make 1e10 m/s in a step.
  EXPECT_EQ(errorAfterRagdoll("gravity: [0, 0, -1.19e12]\n"), "");
  EXPECT_THAT(
      errorAfterRagdoll("gravity: [0, 0, -1.21e12]\n"),
      AllOf(StartsWith("scene.yaml: gravity: is [0, 0, -1.21e+12] m/s^2; at most 1.2e+12")));
}

TEST(SceneErrors, OutOfRangeNamesTheRange) {
  EXPECT_THAT(errorAfterRagdoll("solver: {step: 0}\n"),
              AllOf(StartsWith("scene.yaml:2: solver.step: is 0;"), HasSubstr("to 1 is expected")));
  EXPECT_THAT(errorAfterRagdoll("obstacles: [{type: plane, restitution: 1.5}]\n"),
              StartsWith("scene.yaml:2: obstacles[0].restitution: is 1.5; a number from 0 to 1"));
  EXPECT_THAT(errorAfterRagdoll("obstacles: [{type: plane, friction: -1}]\n"),
              StartsWith("scene.yaml:2: obstacles[0].friction: is -1; 0 or a positive number"));
  EXPECT_THAT(errorAfterRagdoll("obstacles: [{type: plane, normal: [0, 0, 0]}]\n"),
              StartsWith("scene.yaml:2: obstacles[0].normal: has length 0; a direction"));
  EXPECT_THAT(errorAfterRagdoll("obstacles: [{type: box, position: [0, 0, 0], size: [1, 0, 1]}]\n"),
              StartsWith("scene.yaml:2: obstacles[0].size: three edge lengths above 0"));
  EXPECT_THAT(errorOfText("ragdolls: [{model: human, count: 20000}]\n"),
              StartsWith("scene.yaml:1: ragdolls[0].count: is '20000'; a whole number from 1 to"));
  EXPECT_THAT(errorOfText("ragdolls: [{model: human, count: 6000}, {name: b, model: human, "
                          "count: 6000}]\n"),
              StartsWith("scene.yaml:1: ragdolls: are 12000 ragdolls; at most 10000"));
}

TEST(SceneErrors, ChoicesAreListed) {
  EXPECT_THAT(
      errorAfterRagdoll("solver: {preset: quick}\n"),
      StartsWith("scene.yaml:2: solver.preset: is 'quick'; one of thesis, fast, draft, balanced, "
                 "precise, reference is expected"));
  EXPECT_THAT(errorAfterRagdoll("solver: {method: euler}\n"),
              HasSubstr("one of jakobsen, shake, rk, fast"));
  EXPECT_THAT(errorAfterRagdoll("coat: wool\n"), HasSubstr("one of none, sticks, boxes, capsules"));
  EXPECT_THAT(errorAfterRagdoll("obstacles: [{type: cone}]\n"),
              StartsWith("scene.yaml:2: obstacles[0].type: is 'cone'; one of plane, box, sphere"));
}

TEST(SceneErrors, MissingKey) {
  EXPECT_THAT(errorOfText("gravity: [0, 0, 0]\n"),
              StartsWith("scene.yaml:1: the key 'ragdolls' is missing; there is 'gravity'"));
  EXPECT_THAT(errorOfText("ragdolls:\n  - {name: doll, modle: human}\n"),
              StartsWith("scene.yaml:2: ragdolls[0]: the key 'model' is missing; there are 'name', "
                         "'modle'"));
  EXPECT_THAT(errorOfText("ragdolls: [{}]\n"), HasSubstr("'model' is missing; there is none"));
  EXPECT_THAT(errorOfText("ragdolls: []\n"), StartsWith("scene.yaml:1: ragdolls: is empty"));
}

TEST(SceneErrors, IndentationByTab) {
  for (const char* text : {"ragdolls:\n\t- {model: human}\n", "ragdolls:\n  \t- {model: human}\n",
                           "ragdolls:\n  - name: a\n\tmodel: human\n"})
    EXPECT_THAT(errorOfText(text),
                AllOf(StartsWith("scene.yaml:"),
                      HasSubstr("not valid YAML: indented by a tab; spaces are expected")));
  EXPECT_EQ(errorOfText("ragdolls:\t[{name: a,\n\tmodel: human}]\n"), "");  // YAML allows it there
  EXPECT_THAT(errorOfText("ragdolls: [{model: human}\n"), Not(HasSubstr("tab")));
}

TEST(SceneErrors, DuplicateKeyAndName) {
  EXPECT_THAT(errorAfterRagdoll("gravity: [0, 0, 0]\ngravity: [0, 0, 1]\n"),
              StartsWith("scene.yaml:3: gravity: is there twice"));
  EXPECT_THAT(
      errorOfText("ragdolls:\n  - {name: doll, model: human}\n  - {name: doll, model: human}\n"),
      AllOf(StartsWith("scene.yaml:3: ragdolls[1].name"), HasSubstr("'doll'")));
}

TEST(SceneErrors, OrientationGivenTwice) {
  EXPECT_THAT(errorOfText("ragdolls:\n  - {model: human, rpy_deg: [0, 0, 0], rpy: [0, 0, 0]}\n"),
              StartsWith("scene.yaml:2: ragdolls[0].rpy: the orientation is given twice"));
  EXPECT_THAT(errorOfText("ragdolls:\n  - {model: human, quaternion: [0, 0, 0, 0]}\n"),
              StartsWith("scene.yaml:2: ragdolls[0].quaternion: has length 0"));
}

TEST(SceneErrors, UnknownModelListsTheKnown) {
  EXPECT_THAT(errorOfText("ragdolls:\n  - model: humna\n"),
              AllOf(StartsWith("scene.yaml:2: ragdolls[0].model: there is no model 'humna'"),
                    HasSubstr("human")));
  EXPECT_THAT(errorOfText("ragdolls:\n  - model: nowhere/doll.yaml\n"),
              StartsWith("scene.yaml:2: ragdolls[0].model: there is no file"));
}

TEST(SceneErrors, PlaceKnowsTheParticlesOfTheFileAlone) {
  const auto placed = [](const std::string& name) {
    return errorOfText("ragdolls: [{model: human, place: {" + name + ": [0, 0, 1]}}]\n");
  };
  EXPECT_EQ(placed("right_foot"), "");
  for (const char* name : {"paw", "pelvis.inertia"})
    EXPECT_THAT(placed(name), AllOf(HasSubstr("unknown particle '" + std::string(name) + "'"),
                                    HasSubstr("right_foot"), Not(HasSubstr("foot, pelvis"))));
}

TEST(SceneErrors, UnknownBodyListsTheKnown) {
  EXPECT_THAT(
      errorAfterRagdoll("pins: [ragdoll/tail]\n"),
      AllOf(StartsWith("scene.yaml:2: pins[0]"), HasSubstr("tail"), HasSubstr("left_hand")));
  EXPECT_THAT(errorAfterRagdoll("pokes:\n  - {body: tail, force: [1, 0, 0]}\n"),
              AllOf(StartsWith("scene.yaml:3: pokes[0].body"), HasSubstr("tail"),
                    HasSubstr("left_forearm")));
  EXPECT_THAT(errorOfText("ragdolls:\n  - {model: human, place: {tail: [0, 0, 0]}}\n"),
              AllOf(StartsWith("scene.yaml:2: ragdolls[0].place"), HasSubstr("'tail'")));
}

TEST(SceneErrors, SettingsAreCheckedLikeTheFile) {
  Scene scene = parseScene(kRagdoll);
  const std::string before = scene.text;
  const auto setting = [&](const char* key, const char* value) {
    return errorOf([&] { applySetting(scene, key, value); });
  };
  EXPECT_THAT(setting("solver.speed", "1"),
              AllOf(HasSubstr("'solver.speed'"), HasSubstr("solver.step")));
  EXPECT_THAT(setting("ragdolls", "[]"), HasSubstr("the settings are gravity"));
  EXPECT_THAT(setting("solver.step", "fast"),
              StartsWith("setting solver.step: is 'fast'; a number"));
  EXPECT_THAT(setting("solver.step", ""), HasSubstr("empty"));
  EXPECT_THAT(setting("gravity", "[0, 0, .nan]"),
              StartsWith("setting gravity[2]: is '.nan'; a finite number"));
  EXPECT_EQ(scene.text, before);
}

}  // namespace
}  // namespace ragdoll
