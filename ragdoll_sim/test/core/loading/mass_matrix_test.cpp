#include <gtest/gtest.h>

#include "core/loading/skeleton.h"
#include "ragdoll_sim/core/error.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

SkeletonSpec rod(double mass, double com, double gyration) {
  SkeletonSpec s = oneStick(0, 0);
  s.segments[0].mass = mass;
  s.segments[0].com = com;
  s.segments[0].gyration = gyration;
  return s;
}

/// Velocities are linear along a rod, so its energy is a quadratic form of its ends'.
TEST(MassMatrix, OfARodIsItsMoments) {
  const Eigen::MatrixXd M = buildSkeleton(rod(3, 0.4, 0.3)).M;
  EXPECT_NEAR(M(1, 1), 3 * (0.4 * 0.4 + 0.3 * 0.3), 1e-14);
  EXPECT_NEAR(M(0, 0), 3 * (0.6 * 0.6 + 0.3 * 0.3), 1e-14);
  EXPECT_NEAR(M(0, 1), 3 * (0.6 * 0.4 - 0.3 * 0.3), 1e-14);
  EXPECT_NEAR(M.sum(), 3, 1e-14);
}

TEST(MassMatrix, OfParticlesIsDiagonal) {
  const Skeleton s = buildSkeleton(oneStick(2, 5));
  EXPECT_TRUE(s.lumped);
  EXPECT_EQ(s.M(0, 0), 2);
  EXPECT_EQ(s.M(0, 1), 0);
}

TEST(MassMatrix, NeedsMassEverywhere) {
  SkeletonSpec s = oneStick(1, 0);
  EXPECT_THROW(buildSkeleton(s), Error);
}

}  // namespace
}  // namespace ragdoll
