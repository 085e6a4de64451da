#include "core/loading/skeleton.h"

#include <gtest/gtest.h>

#include "support/error_of.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Skeleton, ResolvesNames) {
  SkeletonSpec spec = oneStick();
  const Skeleton s = buildSkeleton(spec);
  EXPECT_EQ(s.size(), 2);
  EXPECT_EQ(s.particle("b"), 1);
  EXPECT_EQ(s.particle("c"), -1);
  EXPECT_EQ(s.segment("ab"), 0);
  ASSERT_EQ(s.sticks.size(), 1U);
  EXPECT_DOUBLE_EQ(s.sticks[0].length, 1);
}

TEST(Skeleton, NeighboursAreRelaxedApart) {
  SkeletonSpec spec = oneStick();
  for (const char* name : {"c", "d"}) {
    const std::string last = spec.particles.back().name;
    spec.particles.push_back(particle(name, spec.particles.back().position + Vec3::UnitX()));
    spec.sticks.push_back(stick(last, name));
  }
  const Skeleton s = buildSkeleton(spec);
  EXPECT_EQ(s.stick_order, (std::vector<int>{0, 2, 1}));  // those at the ends, then the middle one
}

TEST(Skeleton, NamesWhatIsWrong) {
  SkeletonSpec unknown = oneStick();
  unknown.sticks[0].b = "elbow";
  EXPECT_NE(errorOf([&] { buildSkeleton(unknown); }).find("elbow"), std::string::npos);
  SkeletonSpec twice = oneStick();
  twice.particles[1].name = "a";
  EXPECT_NE(errorOf([&] { buildSkeleton(twice); }).find("'a'"), std::string::npos);
}

}  // namespace
}  // namespace ragdoll
