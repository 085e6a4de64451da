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

}  // namespace
}  // namespace ragdoll
