#include <gtest/gtest.h>

#include <cmath>

#include "core/limits/limit_angles.h"
#include "core/loading/skeleton.h"
#include "ragdoll_sim/core/error.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

SkeletonSpec elbow(double begin, double end) {
  SkeletonSpec spec = oneStick();
  spec.particles.push_back(particle("c", Vec3(1 + std::cos(0.5), 0, std::sin(0.5))));
  spec.sticks.push_back(stick("b", "c"));
  spec.segments.push_back(bone("bc", "b", "c"));
  JointSpec joint;
  joint.name = "elbow";
  joint.parent = "ab";
  joint.child = "bc";
  joint.axis = -Vec3::UnitY();  // turns x towards z
  joint.range = {begin, end};
  spec.joints = {joint};
  return spec;
}

/// The rest pose is bent by 0.5. Nothing shows how the upper bone is turned about itself: the lower
/// one may bend by 1.4 to any side, and a warning says so.
TEST(JointLimits, OfABoneThatHangsOnNothingAreACone) {
  const World world(sceneOf(elbow(0.2, 1.4)));
  std::vector<double> values;
  for (int k = 0; k < static_cast<int>(world.model.skeletons[0].limits.size()); ++k) {
    LimitAngles angles;
    values.push_back(angles.at(world.model, world.state.x, 0)[k]);
  }
  ASSERT_EQ(values.size(), 1U);
  EXPECT_NEAR(values[0], 0.9, 1e-12);
  EXPECT_EQ(world.model.skeletons[0].warnings.size(), 1U);
}

TEST(JointLimits, RefuseARangeThatIsNone) { EXPECT_THROW(buildSkeleton(elbow(1.4, 0.2)), Error); }

}  // namespace
}  // namespace ragdoll
