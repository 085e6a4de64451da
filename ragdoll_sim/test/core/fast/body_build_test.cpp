#include "core/fast/body_build.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(FastBody, HasTheModelsMassesAndCoordinates) {
  const Model model = buildModel(sceneOf(chainOfThree()));
  const fast::FastBody body = fast::buildBody(model, model.systems[0]);
  EXPECT_TRUE(body.tree.isTree());
  EXPECT_EQ(body.tree.size, 3 + 2 + 2);  // a root's shift, two rods
  double mass = 0;
  for (const double m : body.tree.mass) mass += m;
  EXPECT_DOUBLE_EQ(mass, 3);
}

/// Those of its pelvis that end on the torso's hip, which is on the fold's axis, too.
TEST(FastBody, HasEveryStickOfTheHuman) {
  const Model model = buildModel(parseScene("ragdolls: [{model: human}]\n"));
  const fast::FastBody body = fast::buildBody(model, model.systems[0]);
  const Skeleton& s = model.skeletons[0];
  const auto count = std::count_if(s.sticks.begin(), s.sticks.end(),
                                   [&s](const Stick& k) { return k.a < s.named && k.b < s.named; });
  EXPECT_EQ(static_cast<long>(body.features.size()) - body.particles, count);
}

}  // namespace
}  // namespace ragdoll
