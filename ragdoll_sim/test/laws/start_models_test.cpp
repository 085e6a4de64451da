// Bodies of every kind that ships, placed outside their joint limits: put right at load.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;

class StartOf : public testing::TestWithParam<const char*> {
 protected:
  /// The right shank turned forward by `degrees` at the knee, and with it the foot: the knee only
  /// bends backward.
  static Scene kneeForward(double degrees) {
    Scene scene = parseScene(std::string("gravity: [0, 0, 0]\nragdolls: [{model: ") + GetParam() +
                             ", position: [0, 0, 1]}]\n");
    const World world(scene);
    const Skeleton& s = world.model.skeletons[0];
    const Vec3 knee = world.x(s.particle("right_knee")), foot = world.x(s.particle("right_foot"));
    const Eigen::AngleAxisd turn(-degrees * M_PI / 180, Vec3::UnitY());
    scene.ragdolls[0].place = {{"right_foot", knee + turn * (foot - knee)}};
    scene.ragdolls[0].where = "ragdolls[0]";
    return scene;
  }
};

TEST_P(StartOf, AKneeBentForwardIsPutRight) {
  for (const double degrees : {14, 40}) {
    const Scene scene = kneeForward(degrees);
    World world(scene);
    ASSERT_EQ(world.model.warnings.size(), 1u);
    EXPECT_THAT(world.model.warnings[0],
                AllOf(HasSubstr("joint 'right_knee'"), HasSubstr("corrected, moved: ")));
    EXPECT_LT(maxLimitViolation(world.model, world.state), 2e-4) << degrees;
    EXPECT_LT(maxStickError(world.model, world.state), 2e-6) << degrees;
    const Skeleton& s = world.model.skeletons[0];
    EXPECT_LT((world.x(s.particle("right_foot")) - scene.ragdolls[0].place[0].second).norm(),
              1e-12);
    double energy = 0;
    for (int i = 0; i < 60; ++i) {
      world.steps(1);
      energy = std::max(energy, kineticEnergy(world.model, world.state));
    }
    EXPECT_LT(energy, 1e-4) << degrees;  // all 80 kg at 2 mm/s
  }
}

INSTANTIATE_TEST_SUITE_P(Models, StartOf, testing::Values("human", "human_lumped", "human_thesis"));

}  // namespace
}  // namespace ragdoll
