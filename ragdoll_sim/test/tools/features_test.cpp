// ragdoll_lab features: each scene has what its name says and nothing else, and the table has a
// line for each.
#include <gmock/gmock.h>

#include <cstdio>
#include <sstream>

#include "feature_list.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/lab_program.h"

namespace ragdoll::lab {
namespace {

/// Most contacts that pressed in a step of the first 2 s.
int contactsOf(const Feature& feature) {
  Scene scene = parseScene(feature.scene, feature.name);
  scene.solver.sleep = false;
  const Model model = buildModel(scene);
  State state = startState(model);
  Workspace workspace;
  int most = 0;
  for (int i = 0; i < 2 / model.solver.step; ++i)
    most = std::max(most, step(model, startInputs(model), workspace, state).contacts);
  return most;
}

TEST(Features, EachIsOnAloneAndDoesSomething) {
  const std::vector<Feature> all = features();
  ASSERT_GT(all.size(), 15u);
  EXPECT_EQ(all[0].scene, bareScene());
  const Model bare = buildModel(parseScene(bareScene(), "bare"));
  EXPECT_TRUE(bare.obstacles.empty() && bare.pins.empty() && bare.skeletons[0].lumped);
  for (const Feature& feature : all) {
    SCOPED_TRACE(feature.group + ": " + feature.name);
    const Model model = buildModel(parseScene(feature.scene, feature.name));
    const bool together = feature.group == "segments, limits, plane" || feature.group == "the same";
    EXPECT_EQ(feature.limits, feature.name == "limits" || together);
    EXPECT_EQ(model.skeletons[0].lumped, feature.group != "inertia" && !together);
    EXPECT_EQ(model.pins.size(), feature.group == "pin" ? 1u : 0u);
    EXPECT_EQ(model.solver.joint_damping > 0, feature.name == "damping");
    const bool senses = feature.group == "senses", touches = feature.name == "contacts, on a plane";
    EXPECT_EQ(model.obstacles.size(), feature.group == "obstacle" || together || touches ? 1u : 0u);
    EXPECT_EQ(model.sensors.size(), senses && !touches ? 1u : 0u);
    EXPECT_EQ(model.ragdolls.size(), model.ragdoll_collision ? 2u : 1u);
    EXPECT_EQ(feature.follower != nullptr, feature.group == "frames and coat" ||
                                               feature.group == "publishing at 60 Hz" || senses);
    if (!model.obstacles.empty()) {
      EXPECT_EQ(model.obstacles[0].friction > 0, feature.name != "plane without friction");
      EXPECT_EQ(contactsOf(feature) > 0, feature.name != "plane, out of reach");
    }
    if (model.ragdoll_collision) {
      EXPECT_GT(contactsOf(feature), 0) << "they miss each other";
    }
  }
}

}  // namespace
}  // namespace ragdoll::lab

#ifdef RAGDOLL_LAB

namespace ragdoll {
namespace {

class LabFeatures : public test::LabProgram {};

TEST_F(LabFeatures, PrintsACostAndARatioForEach) {
  const test::Outcome outcome = lab("features --seconds 0.1 --set solver.step=0.02");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  std::istringstream lines(outcome.output);
  std::string line;
  std::getline(lines, line);
  for (const lab::Feature& feature : lab::features()) {
    ASSERT_TRUE(std::getline(lines, line)) << feature.name;
    const std::string name = feature.group + ": " + feature.name;
    EXPECT_EQ(line.substr(0, name.size()), name);
    double cost = -1, ratio = -1;
    EXPECT_EQ(std::sscanf(line.c_str() + 64, "%lf %lf", &cost, &ratio), 2) << line;
    EXPECT_GE(cost, 0);
    EXPECT_GT(ratio, 0);
  }
  EXPECT_FALSE(std::getline(lines, line)) << line;
}

TEST_F(LabFeatures, SaysWhatIsWrong) {
  EXPECT_EQ(lab("features --seconds nan").status, 2);
  EXPECT_EQ(lab("features --seconds 1e300").status, 2);
  EXPECT_EQ(lab("features --set solver.step=0").status, 2);
  EXPECT_EQ(lab("features fall").status, 2);
}

}  // namespace
}  // namespace ragdoll

#endif  // RAGDOLL_LAB
