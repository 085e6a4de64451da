#include "ragdoll_sim/core/model.h"

#include <gtest/gtest.h>

#include "support/direct_island.h"
#include "support/error_of.h"

namespace ragdoll {
namespace {

using namespace test;

/// Two chains a-b-c; segments ab and bc.
Model twoChains() {
  Scene scene = sceneOf(chainOfThree());
  scene.ragdolls.push_back(scene.ragdolls[0]);
  scene.ragdolls[0].name = "first";
  scene.ragdolls[1].name = "second";
  scene.ragdolls[1].pose.position = Vec3(0, 5, 0);
  return buildModel(scene);
}

std::string refusal(const Model& model, const std::string& name) {
  return errorOf([&] { findBody(model, name); });
}

TEST(FindBody, TakesTheFirstThatHasItOrTheOneNamed) {
  const Model model = twoChains();
  EXPECT_EQ(findBody(model, "b").ragdoll, 0);
  EXPECT_EQ(findBody(model, "b").particles, std::vector<int>{1});
  EXPECT_EQ(findBody(model, "second/b").ragdoll, 1);
  EXPECT_EQ(findBody(model, "second/b").particles, std::vector<int>{4});
  const BodyRef segment = findBody(model, "second/bc");
  EXPECT_EQ(segment.particles, (std::vector<int>{4, 5}));
  EXPECT_EQ(segment.weight, (std::vector<double>{0.5, 0.5}));
}

TEST(FindBody, NamesWhatThereIs) {
  const Model model = twoChains();
  for (const std::string name : {"hand", "second/hand"}) {
    EXPECT_NE(refusal(model, name).find("unknown body '" + name + "'"), std::string::npos);
    EXPECT_NE(refusal(model, name).find("there are a, b, c, ab, bc"), std::string::npos);
  }
  const std::string third = refusal(model, "third/a");
  EXPECT_NE(third.find("unknown ragdoll 'third'"), std::string::npos) << third;
  EXPECT_NE(third.find("first"), std::string::npos) << third;
  EXPECT_NE(third.find("second"), std::string::npos) << third;
}

TEST(Skeleton, RegionIsTheBoneThatEndsThere) {
  const Model model = twoChains();
  const Skeleton& s = model.skeletonOf(model.ragdolls[0]);
  EXPECT_EQ(s.region(2, -1), s.segment("bc"));
  EXPECT_EQ(s.region(1, -1), s.segment("ab"));  // bc begins there
  EXPECT_EQ(s.region(0, -1), s.segment("ab"));  // none ends there: the first that has it
  EXPECT_EQ(s.region(1, 2), s.segment("bc"));
  EXPECT_EQ(s.region(0, 2), -1);
  EXPECT_EQ(s.particle("c"), 2);
  EXPECT_EQ(s.segment("cd"), -1);
}

}  // namespace
}  // namespace ragdoll
