// A start outside the joint limits: put right at load, so that nothing explodes at spawn.
#include "ragdoll_sim/core/start_pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/measures.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// The arm of limbs() with its elbow bent by `back` degrees to the wrong side, weightless.
Scene armBentBack(double back, double stretch = 1, double stiffness = 0) {
  SkeletonSpec body = jointedLimbs();
  if (stiffness > 0)
    for (JointSpec& j : body.joints) j.stiffness = stiffness;
  Scene scene = sceneOf(body, Vec3(1, 2, 3));
  const Vec3 elbow = Vec3(1, 2, 3) + Vec3(0, -0.2, 0.2);
  const Vec3 along(-std::sin(rad(back)), 0, -std::cos(rad(back)));
  scene.gravity.setZero();
  scene.ragdolls[0].place = {{"hand", elbow + 0.25 * stretch * along},
                             {"finger", elbow + (0.25 * stretch + 0.15) * along}};
  return scene;
}

Vec3 at(const World& world, const std::string& particle) {
  return world.state.x.col(world.model.skeletons[0].particle(particle));
}

TEST(StartPose, JointsOutsideTheirLimitsArePutRightWithAWarning) {
  for (const double back : {5, 40, 80}) {
    const Scene scene = armBentBack(back);
    World world(scene);
    EXPECT_LT(maxLimitViolation(world.model, world.state), 2e-4) << back;
    EXPECT_LT(maxStickError(world.model, world.state), 2e-4) << back;
    for (const auto& [name, position] : scene.ragdolls[0].place)
      EXPECT_EQ(at(world, name), position) << name;  // what is placed stays
    ASSERT_EQ(world.model.warnings.size(), 1u);
    EXPECT_THAT(world.model.warnings[0],
                AllOf(HasSubstr("ragdoll 'ragdoll': place leaves joint 'elbow' " +
                                std::to_string(static_cast<int>(back)) + ".0 deg outside"),
                      HasSubstr("corrected, moved: elbow by ")));
  }
}

TEST(StartPose, DoesNotExplode) {
  for (const Method method : {Method::kJakobsen, Method::kShake, Method::kRk}) {
    Scene scene = armBentBack(60);
    scene.solver.method = method;
    World world(scene);
    double energy = 0;
    for (int i = 0; i < 60; ++i) {
      world.steps(1);
      energy = std::max(energy, kineticEnergy(world.model, world.state));
    }
    // At rest as it began: less than 1 cm/s of the 47 kg.
    EXPECT_LT(energy, 0.5 * 47 * 1e-4) << static_cast<int>(method);
  }
}

TEST(StartPose, PinsThatHoldItOutsideAreTold) {
  Scene scene = armBentBack(40);
  PinSpec pin;
  for (const char* name : {"hand", "elbow", "a", "b", "c"}) {
    pin.particle = name;
    scene.pins.push_back(pin);
  }
  World world(scene);  // arm and trunk are held where they are: nothing can be done
  EXPECT_NEAR(deg(maxLimitViolation(world.model, world.state)), 40, 1e-9);
  ASSERT_EQ(world.model.warnings.size(), 1u);
  EXPECT_THAT(world.model.warnings[0], HasSubstr("no way was found"));
}

TEST(StartPose, WhatIsRightOrSoftOrApartStaysAsItIs) {
  const auto untouched = [](const Scene& scene) {
    World world(scene);
    const Skeleton& s = world.model.skeletons[0];
    Points expected = s.rest.colwise() + Vec3(1, 2, 3);
    for (const auto& [name, position] : scene.ragdolls[0].place)
      expected.col(s.particle(name)) = position;
    EXPECT_EQ((world.state.x - expected).cwiseAbs().maxCoeff(), 0);
    return world.model.warnings;
  };
  EXPECT_TRUE(untouched(armBentBack(-30)).empty());        // inside
  EXPECT_TRUE(untouched(armBentBack(0.9)).empty());        // a little outside
  EXPECT_TRUE(untouched(armBentBack(40, 1, 50)).empty());  // a spring presses it back
  const std::vector<std::string> apart = untouched(armBentBack(40, 2));
  ASSERT_EQ(apart.size(), 1u);
  EXPECT_THAT(apart[0], AllOf(HasSubstr("joint 'elbow' 40.0 deg outside"),
                              HasSubstr("sticks are off their lengths")));
}

}  // namespace
}  // namespace ragdoll
