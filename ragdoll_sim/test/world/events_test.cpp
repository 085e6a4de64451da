#include "ragdoll_sim/world/events.h"

#include <gtest/gtest.h>

namespace ragdoll {
namespace {

TEST(Events, APokeIsKnownByItsBodyStartForceAndPoint) {
  Poke poke;
  poke.body_name = "head";
  poke.start = 0.5;
  poke.force = Vec3(1, 2, 3);
  EXPECT_TRUE(contains({Poke(), poke}, poke));
  Poke other = poke;
  other.body_name = "torso";
  EXPECT_FALSE(contains({other}, poke));
  other = poke;
  other.start = 1;
  EXPECT_FALSE(contains({other}, poke));
  other = poke;
  other.force.x() = 0;
  EXPECT_FALSE(contains({other}, poke));
  other = poke;
  other.point.z() = 0.1;
  EXPECT_FALSE(contains({other}, poke));
}

}  // namespace
}  // namespace ragdoll
