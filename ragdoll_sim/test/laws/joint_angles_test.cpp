// Joint angles as they are published against the limits of the model file, over random falls.
#include <gtest/gtest.h>

#include "ragdoll_sim/body/angles.h"
#include "support/falls.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(JointAngles, OfHingesStayInTheRangesThatTheLimitsKeep) {
  std::mt19937 random(7);
  double largest = 0;
  for (int fall = 0; fall < 40; ++fall) {
    World world(randomFall(fall % 2 ? "stairs" : "between_objects", random));
    FrameTracker tracker(world.model);
    tracker.reset(world.state);
    const JointAngles angles(world.model, tracker);
    std::vector<double> values;
    for (int i = 0; i < 500; ++i) {
      world.steps(1);
      tracker.update(world.state);
      angles.compute(tracker.now(), values);
      const double slack = 2 * maxLimitViolation(world.model, world.state) + 1e-6;
      for (const Joint& joint : world.model.skeletons[0].joints) {
        if (joint.type != JointSpec::Type::kHinge) continue;
        const auto& names = angles.names();
        const auto at = std::find(names.begin(), names.end(), joint.name + "_y");
        ASSERT_NE(at, names.end());
        const double value = values[at - names.begin()];
        ASSERT_GT(value, joint.range.begin - slack) << joint.name << " of fall " << fall;
        ASSERT_LT(value, joint.range.end + slack) << joint.name << " of fall " << fall;
        largest = std::max(largest, value - joint.range.end);
      }
    }
  }
  EXPECT_GT(largest, -1e-3) << "no limit was reached";
}

}  // namespace
}  // namespace ragdoll
