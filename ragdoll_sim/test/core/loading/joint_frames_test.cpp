#include "ragdoll_sim/core/joint_frames.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/loading/skeleton.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(JointFrames, TurnsAndBendsAreInverse) {
  EXPECT_DOUBLE_EQ(bendOfTurn(0.7, 1), 0.7);                      // an axis square to the bone
  EXPECT_NEAR(bendOfTurn(M_PI, 0.5), 2 * std::asin(0.5), 1e-15);  // a half turn on a cone
  for (const double turn : {-2.0, -0.1, 0.0, 0.4, 3.0})
    EXPECT_NEAR(turnOfBend(bendOfTurn(turn, 0.6), 0.6), turn, 1e-12);
}

TEST(JointFrames, TurnedIsARotation) {
  EXPECT_LT((turned(M_PI / 2, Vec3::UnitZ(), Vec3::UnitX()) - Vec3::UnitY()).norm(), 1e-15);
}

/// An upper arm along x, a forearm along z.
TEST(JointFrames, BonesPointAwayFromTheirJoint) {
  SkeletonSpec spec = oneStick();
  spec.particles.push_back(particle("c", Vec3(1, 0, 2)));
  spec.sticks.push_back(stick("c", "b"));
  spec.segments.push_back(bone("cb", "c", "b"));  // named from the far end
  JointSpec elbow;
  elbow.name = "elbow";
  elbow.parent = "ab";
  elbow.child = "cb";
  elbow.axis = Vec3::UnitY();
  elbow.range = {-2.5, 0};
  spec.joints = {elbow};
  const Skeleton s = buildSkeleton(spec);
  const JointFrames frames(s);
  EXPECT_EQ(frames.boneFrom(1, 0), std::make_pair(1, 2));
  EXPECT_LT((frames.childRest(0) - Vec3::UnitZ()).norm(), 1e-15);
  EXPECT_LT((frames.hingeZero(0) - Vec3::UnitX()).norm(), 1e-15);  // straight on
}

}  // namespace
}  // namespace ragdoll
