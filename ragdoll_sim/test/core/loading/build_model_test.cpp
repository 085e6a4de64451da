#include "ragdoll_sim/core/build_model.h"

#include <gtest/gtest.h>

#include "support/error_of.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(BuildModel, SharesWhatIsEqual) {
  Scene scene = sceneOf(oneStick());
  scene.ragdolls.push_back(scene.ragdolls[0]);
  scene.ragdolls[1].name = "other";
  const Model model = buildModel(scene);
  EXPECT_EQ(model.skeletons.size(), 1U);
  EXPECT_EQ(model.ragdolls[1].first, 2);
  EXPECT_EQ(&model.systemOf(model.ragdolls[0]), &model.systemOf(model.ragdolls[1]));
}

TEST(BuildModel, NamesAPinThatIsNone) {
  Scene scene = sceneOf(oneStick());
  scene.pins = {pinOf("elbow")};
  const std::string error = errorOf([&] { buildModel(scene); });
  EXPECT_NE(error.find("elbow"), std::string::npos) << error;
}

TEST(BuildModel, PinsCanBeSetAnew) {
  Model model = buildModel(sceneOf(oneStick()));
  EXPECT_TRUE(model.systemOf(model.ragdolls[0]).pins.empty());
  Pin pin{};
  pin.particle = 1;
  setPins(model, {pin});
  EXPECT_EQ(model.systemOf(model.ragdolls[0]).pins, std::vector<int>{1});
  setPins(model, {});
  EXPECT_TRUE(model.systemOf(model.ragdolls[0]).pins.empty());
}

/// Of the one warning that a scene gives.
std::string warningOf(const Scene& scene) {
  const std::vector<std::string> warnings = buildModel(scene).warnings;
  return warnings.size() == 1 ? warnings[0] : std::to_string(warnings.size()) + " warnings";
}

TEST(BuildModel, WarnsOfSettingsThatDoNothing) {
  Scene scene = sceneOf(oneStick());
  for (const Method method : {Method::kFast, Method::kJakobsen}) {
    scene.solver.method = method;
    EXPECT_TRUE(buildModel(scene).warnings.empty());
    scene.solver.tolerance = 1e-4;
    EXPECT_NE(warningOf(scene).find("tolerance: is 0.0001, which only"), std::string::npos);
    scene.solver.tolerance = 0;
  }
  scene.solver.events = true;
  EXPECT_NE(warningOf(scene).find("events: is true, which only"), std::string::npos);
  scene.solver.method = Method::kRk;
  EXPECT_TRUE(buildModel(scene).warnings.empty());
  scene.solver.tolerance = 1e-4;
  EXPECT_TRUE(buildModel(scene).warnings.empty());
  scene.solver.tolerance = 0;
  scene.solver.events = false;
  scene.solver.method = Method::kFast;
  scene.ragdoll_collision = true;
  EXPECT_TRUE(buildModel(scene).warnings.empty());
  scene.solver.method = Method::kShake;
  scene.solver.tolerance = 1e-4;
  EXPECT_TRUE(buildModel(scene).warnings.empty());
}

TEST(BuildModel, WarnsOfBodiesThatPacksDoNotTake) {
  SkeletonSpec square = oneParticle();
  square.name = "square";
  square.particles = {particle("a", {0, 0, 0}), particle("b", {1, 0, 0}), particle("c", {1, 1, 0}),
                      particle("d", {0, 1, 0})};
  square.sticks = {stick("a", "b"), stick("b", "c"), stick("c", "d"), stick("d", "a")};
  Scene scene = sceneOf(square);
  EXPECT_TRUE(buildModel(scene).warnings.empty());
  scene.solver.method = Method::kFast;
  EXPECT_NE(warningOf(scene).find("square: no tree (c, d close a loop)"), std::string::npos)
      << warningOf(scene);
}

}  // namespace
}  // namespace ragdoll
