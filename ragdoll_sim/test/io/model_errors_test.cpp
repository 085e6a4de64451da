// Whatever is wrong in a model, the user is told where (file, line, key), what, and what would be
// right.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "errors_of_text.h"
#include "ragdoll_sim/core/build_model.h"

namespace ragdoll {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

// Lines 4, 5 and 6 of the scene.
const char kTwo[] =
    "      particles:\n"
    "        a: {position: [0, 0, 0], mass: 1}\n"
    "        b: {position: [0, 0, 1], mass: 1}\n";

std::string errorAfterTwo(const std::string& text) {
  return errorOfText(sceneWithModel(kTwo + text));
}

std::string errorOfParticle(const std::string& particle) {
  return errorOfText(sceneWithModel("      particles:\n        a: " + particle + "\n"));
}

TEST(ModelErrors, AcceptsTheModelThatTheOthersBreak) {
  EXPECT_EQ(errorAfterTwo("      sticks: [[a, b]]\n"), "");
  EXPECT_EQ(errorOfParticle("{position: [0, 0, 0], mass: 1}"), "");
}

TEST(ModelErrors, NegativeMass) {
  EXPECT_THAT(errorOfParticle("{position: [0, 0, 0], mass: -2}"),
              StartsWith("scene.yaml:5: ragdolls[0].model.particles.a.mass: is -2; 0 or a positive "
                         "number is expected"));
}

TEST(ModelErrors, MassOfNothing) {
  EXPECT_THAT(errorOfParticle("{position: [0, 0, 0]}"),
              AllOf(StartsWith("scene.yaml:5: ragdolls[0].model.particles.a"), HasSubstr("mass")));
}

TEST(ModelErrors, UnknownKeyWrongTypeAndNan) {
  EXPECT_THAT(
      errorOfParticle("{position: [0, 0, 0], mas: 2}"),
      StartsWith("scene.yaml:5: ragdolls[0].model.particles.a.mas: unknown key; the keys here "
                 "are position, mass, radius"));
  EXPECT_THAT(
      errorOfParticle("{position: 3, mass: 2}"),
      StartsWith("scene.yaml:5: ragdolls[0].model.particles.a.position: is '3'; a list of 3"));
  EXPECT_THAT(errorOfParticle("{position: [0, 0, 0], mass: .nan}"),
              StartsWith("scene.yaml:5: ragdolls[0].model.particles.a.mass: is '.nan'; a finite"));
}

TEST(ModelErrors, FartherOutThanNumbersReach) {
  EXPECT_EQ(errorOfParticle("{position: [0, 0, -1e9], mass: 2, radius: 1e9}"), "");
  EXPECT_THAT(errorOfParticle("{position: [0, 0, -2e9], mass: 2}"),
              AllOf(StartsWith("scene.yaml:5: ragdolls[0].model.particles.a.position: is [0, 0, "
                               "-2e+09] m; numbers from -1e+09 to 1e+09")));
  EXPECT_THAT(errorOfParticle("{position: [0, 0, 0], mass: 2, radius: 1e20}"),
              StartsWith("scene.yaml:5: ragdolls[0].model.particles.a.radius: is 1e+20 m; a number "
                         "from 0 to 1e+09"));
  EXPECT_THAT(errorAfterTwo("      sticks: [[a, b, 1e20]]\n"),
              StartsWith("scene.yaml:7: ragdolls[0].model.sticks[0]: is 1e+20 m; a number from 0"));
}

TEST(ModelErrors, DuplicateParticle) {
  EXPECT_THAT(errorAfterTwo("        a: {position: [1, 0, 1], mass: 1}\n"),
              StartsWith("scene.yaml:7: ragdolls[0].model.particles.a: is there twice"));
}

TEST(ModelErrors, NameThatIsNone) {
  EXPECT_THAT(
      errorAfterTwo("        a/b: {position: [1, 0, 1], mass: 1}\n"),
      AllOf(StartsWith("scene.yaml:7: ragdolls[0].model.particles.'a/b'"), HasSubstr("a name")));
}

TEST(ModelErrors, StickToAnUnknownParticle) {
  EXPECT_THAT(errorAfterTwo("      sticks:\n        - [a, b]\n        - [a, c]\n"),
              AllOf(StartsWith("scene.yaml:9: ragdolls[0].model.sticks[1]"), HasSubstr("'c'"),
                    HasSubstr("a, b")));
}

TEST(ModelErrors, ZeroLengthStick) {
  EXPECT_THAT(errorOfText(sceneWithModel("      particles:\n"
                                         "        a: {position: [0, 0, 1], mass: 1}\n"
                                         "        b: {position: [0, 0, 1], mass: 1}\n"
                                         "      sticks: [[a, b]]\n")),
              AllOf(StartsWith("scene.yaml:7: ragdolls[0].model.sticks[0]"), HasSubstr("length")));
  EXPECT_THAT(errorAfterTwo("      sticks: [[a, b, 0]]\n"),
              StartsWith("scene.yaml:7: ragdolls[0].model.sticks[0][2]: is 0; a number above 0"));
  EXPECT_THAT(errorAfterTwo("      sticks: [[a, a]]\n"),
              StartsWith("scene.yaml:7: ragdolls[0].model.sticks[0]"));
  EXPECT_THAT(
      errorAfterTwo("      sticks: [[a]]\n"),
      StartsWith("scene.yaml:7: ragdolls[0].model.sticks[0]: has 1 items; [particle, particle]"));
}

TEST(ModelErrors, LengthsThatDoNotCloseNameTheirSticks) {
  EXPECT_THAT(errorAfterTwo("        c: {position: [1, 0, 1], mass: 1}\n"
                            "      sticks:\n"
                            "        - [a, b, 1]\n"
                            "        - [b, c, 1.41]\n"
                            "        - [c, a, 5]\n"),
              AllOf(StartsWith("scene.yaml:11: ragdolls[0].model.sticks[2]: no pose gives"),
                    HasSubstr("'c-a' of 5 m would be"), HasSubstr("'a-b' of 1 m would be"),
                    HasSubstr("'b-c' of 1.41 m would be")));
}

TEST(ModelErrors, Segments) {
  EXPECT_THAT(
      errorAfterTwo("      segments:\n        s: {particles: [a, b]}\n"),
      StartsWith("scene.yaml:8: ragdolls[0].model.segments.s.particles: has 2 particles; a rigid "
                 "group has 3 or more"));
  EXPECT_THAT(errorAfterTwo("      segments:\n        s: {from: a}\n"),
              StartsWith("scene.yaml:8: ragdolls[0].model.segments.s: the key 'to' is missing"));
  EXPECT_THAT(errorAfterTwo("      segments:\n        s: {from: a, to: c}\n"),
              AllOf(StartsWith("scene.yaml:8: ragdolls[0].model.segments.s"), HasSubstr("'c'")));
  EXPECT_THAT(errorAfterTwo("      segments:\n        s: {from: a, to: b, mass: -1}\n"),
              StartsWith("scene.yaml:8: ragdolls[0].model.segments.s.mass: is -1;"));
}

TEST(ModelErrors, ABoneWithoutAStickIsTold) {
  const auto warnings = [](const std::string& sticks, const std::string& segments) {
    return buildModel(
               parseScene(
                   sceneWithModel("      particles:\n"
                                  "        a: {position: [0, 0, 0], mass: 1}\n"
                                  "        b: {position: [0, 0, 1], mass: 1}\n"
                                  "        c: {position: [0, 1, 1], mass: 1}\n"
                                  "      sticks: " +
                                  sticks + "\n      segments:\n        bone: {from: a, to: b}\n" +
                                  segments),
                   "scene.yaml"))
        .warnings;
  };
  EXPECT_THAT(warnings("[[a, c], [c, b]]", ""),
              ElementsAre("scene.yaml:10: ragdolls[0].model.segments.bone: no stick joins 'a' and "
                          "'b', so the bone has no fixed length; add [a, b] to the sticks"));
  EXPECT_THAT(warnings("[[b, a], [c, b]]", ""), IsEmpty());
  EXPECT_THAT(
      warnings("[]", "        all: {particles: [a, b, c], mass: 1, inertia: [1, 1, 1, 0, 0, 0]}\n"),
      IsEmpty());
}

std::string errorOfJoint(const std::string& joint) {
  return errorOfText(
      sceneWithModel("      particles:\n"
                     "        a: {position: [0, 0, 2], mass: 1}\n"
                     "        b: {position: [0, 0, 1], mass: 1}\n"
                     "        c: {position: [0, 0, 0], mass: 1}\n"
                     "      sticks: [[a, b], [b, c]]\n"
                     "      segments: {upper: {from: a, to: b}, lower: {from: b, to: c}}\n"
                     "      joints:\n"
                     "        j: {parent: upper, " +
                     joint + "}\n"));
}

TEST(ModelErrors, Joints) {
  const std::string where = "scene.yaml:11: ragdolls[0].model.joints.j";
  EXPECT_EQ(errorOfJoint("child: lower, type: hinge, axis: [0, 1, 0], range_deg: [0, 130]"), "");
  EXPECT_THAT(errorOfJoint("child: lower, type: slider"),
              StartsWith(where + ".type: is 'slider'; one of hinge, cone, planes is expected"));
  EXPECT_THAT(errorOfJoint("child: lower, type: hinge, range_deg: [0, 130]"),
              StartsWith(where + ": the key 'axis' is missing"));
  EXPECT_THAT(
      errorOfJoint("child: lower, type: hinge, axis: [0, 1, 0]"),
      StartsWith(where + ": the key 'range_deg' is missing; there are 'parent', 'child', "));
  EXPECT_THAT(errorOfJoint("child: lower, type: hinge, axis: [0, 1, 0], range_deg: [130, 0]"),
              StartsWith(where + ".range_deg: begins above its end"));
  EXPECT_THAT(errorOfJoint("child: lower, type: hinge, axis: [0, 0, 0], range_deg: [0, 130]"),
              StartsWith(where + ".axis: has length 0"));
  EXPECT_THAT(errorOfJoint("child: lower, type: cone, axis: [0, 0, 1], half_angle_deg: 181"),
              StartsWith(where + ".half_angle_deg: is more than half a turn"));
  EXPECT_THAT(errorOfJoint("child: lower, type: cone, axis: [0, 0, 1], half_angle: 40"),
              AllOf(StartsWith(where + ".half_angle: is more than half a turn"),
                    HasSubstr("'half_angle_deg'")));
  EXPECT_THAT(errorOfJoint("child: lower, type: planes"), StartsWith(where + ": has no region"));
  EXPECT_THAT(errorOfJoint("child: lower, type: cone, axis: [0, 0, 1], half_angle_deg: 40, "
                           "stiffness: 0"),
              StartsWith(where + ".stiffness: is 0; a number above 0"));
  EXPECT_THAT(errorOfJoint("child: tail, type: cone, axis: [0, 0, 1], half_angle_deg: 40"),
              AllOf(StartsWith(where), HasSubstr("tail")));
}

}  // namespace
}  // namespace ragdoll
