#include "core/limits/limit_angles.h"

#include <gtest/gtest.h>

#include "support/limit_rows.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(LimitAngles, AreTheLimitsOfTheLastPoses) {
  const OneJoint neck(cone("neck", "trunk", "head", Vec3::UnitZ(), 40), "a", "head");
  LimitAngles angles;
  std::vector<Points> poses;
  for (const double angle : {0.0, 30.0, 60.0}) poses.push_back(neck.posed(bent(180 - angle)));
  for (int round = 0; round < 2; ++round)  // again: as they were kept
    for (std::size_t i = 0; i < poses.size(); ++i) {
      LimitAngles::Pose& pose = angles.at(neck.model, poses[i], 0);
      EXPECT_NEAR(pose[0], rad(40 - 30.0 * static_cast<double>(i)), 1e-12);
      LimitRow kept = limitRow(neck.model, 0, 0), fresh = kept;
      pose.evaluate(kept, poses[i].data());
      evaluateLimit(neck.model, poses[i], fresh);
      ASSERT_EQ(kept.count, fresh.count);
      EXPECT_EQ(kept.value, fresh.value);
      for (int k = 0; k < fresh.count; ++k) {
        EXPECT_EQ(kept.particle[k], fresh.particle[k]);
        EXPECT_EQ(kept.gradient[k], fresh.gradient[k]);
      }
    }
}

}  // namespace
}  // namespace ragdoll
