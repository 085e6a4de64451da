#include "ragdoll_sim/core/self_pairs.h"

#include <gtest/gtest.h>

#include "core/loading/skeleton.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// Four sticks in a row: neighbours share a particle, the others may touch.
TEST(SelfPairs, AreThoseThatShareNothing) {
  SkeletonSpec spec = oneStick(1, 1, 0.05);
  for (const char* name : {"c", "d", "e"}) {
    const std::string last = spec.particles.back().name;
    spec.particles.push_back(
        particle(name, spec.particles.back().position + Vec3::UnitX(), 1, 0.05));
    spec.sticks.push_back(stick(last, name));
  }
  Skeleton s = buildSkeleton(spec);
  addCapsules(s, true);
  EXPECT_EQ(s.capsules.size(), 4U);
  EXPECT_EQ(s.self_pairs.size(), 3U);
  EXPECT_EQ(s.left_out_pairs.size(), 3U);
  for (const LeftOutPair& pair : s.left_out_pairs)
    EXPECT_EQ(pair.why, LeftOutPair::Why::kSharedParticle);
  EXPECT_EQ(capsuleName(s, 0), "a-b");
}

TEST(SelfPairs, AreNotWhatOverlapsAtRest) {
  SkeletonSpec spec = oneStick(1, 1, 0.2);
  spec.particles.push_back(particle("c", Vec3(0, 0.3, 0), 1, 0.2));
  spec.particles.push_back(particle("d", Vec3(1, 0.3, 0), 1, 0.2));
  spec.sticks.push_back(stick("c", "d"));
  Skeleton s = buildSkeleton(spec);
  addCapsules(s, true);
  EXPECT_TRUE(s.self_pairs.empty());
  ASSERT_EQ(s.left_out_pairs.size(), 1U);
  EXPECT_EQ(s.left_out_pairs[0].why, LeftOutPair::Why::kOverlapAtRest);
}

}  // namespace
}  // namespace ragdoll
