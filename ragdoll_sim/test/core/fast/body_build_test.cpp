#include "core/fast/body_build.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/core/build_model.h"
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

}  // namespace
}  // namespace ragdoll
