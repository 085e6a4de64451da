#include "core/loading/rigid_groups.h"

#include <gtest/gtest.h>

#include "core/loading/skeleton.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

Points corners(int count) {
  Points all(3, 4);
  all << 0, 1, 0, 0, /**/ 0, 0, 1, 0, /**/ 0, 0, 0, 1;
  return all.leftCols(count);
}

SkeletonSpec tetrahedron() {
  SkeletonSpec s;
  s.name = "tetrahedron";
  for (int i = 0; i < 4; ++i)
    s.particles.push_back(particle(std::string(1, static_cast<char>('a' + i)), corners(4).col(i)));
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j)
      s.sticks.push_back(stick(s.particles[i].name, s.particles[j].name));
  return s;
}

TEST(RigidGroups, RankIsOfTheSpan) {
  EXPECT_EQ(affineRank(corners(2)), 1);
  EXPECT_EQ(affineRank(corners(3)), 2);
  EXPECT_EQ(affineRank(corners(4)), 3);
  Points line(3, 3);
  line << 0, 1, 2, /**/ 0, 2, 4, /**/ 0, 3, 6;
  EXPECT_EQ(affineRank(line), 1);
}

TEST(RigidGroups, AreCompleteGraphsOfSticks) {
  const Skeleton s = buildSkeleton(tetrahedron());
  ASSERT_EQ(s.groups.size(), 1U);
  EXPECT_EQ(s.groups[0].particles, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(s.groups[0].rank, 3);
  SkeletonSpec open = tetrahedron();
  open.sticks.pop_back();  // then it hinges
  EXPECT_TRUE(buildSkeleton(open).groups.empty());
}

/// The frame's points hold the group: its particles are where the map puts them.
TEST(RigidGroups, BaseMapGivesTheParticlesBack) {
  for (const SkeletonSpec& spec : {oneStick(), tetrahedron()}) {
    const Skeleton s = buildSkeleton(spec);
    const BaseMap map = baseMap(s);
    EXPECT_TRUE((map.L * map.T).isIdentity(1e-12));
    EXPECT_LT((s.rest * (map.T * map.L).transpose() - s.rest).norm(), 1e-12);
    const Points base = s.rest * map.L.transpose(), sticks = base * map.sticks.transpose();
    for (int k = 0; k < sticks.cols(); ++k) EXPECT_NEAR(sticks.col(k).norm(), map.length[k], 1e-12);
  }
}

}  // namespace
}  // namespace ragdoll
