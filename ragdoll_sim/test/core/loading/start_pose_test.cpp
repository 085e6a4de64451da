// A start outside the joint limits: put right at load, so that nothing explodes at spawn.
#include "core/loading/start_pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/measures.h"
#include "support/error_of.h"
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
  for (const double back : {1, 5, 40, 80}) {
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

/// Limbs whose rest pose is half a degree outside of one joint of each kind, weightless.
Scene restOutside() {
  constexpr double kBy = 0.5;
  SkeletonSpec body = limbs();
  body.joints = {planes("shoulder", "trunk", "upper_arm"),
                 hinge("elbow", "upper_arm", "forearm", -Vec3::UnitY(), kBy, 130),
                 cone("neck", "trunk", "head", Vec3(0, 0, 1), 0)};
  body.joints[0].planes[1] = AngleRange{rad(90 + kBy), rad(200)};
  const Vec3 head = body.particles[6].position - body.particles[0].position;
  body.joints[2].half_angle = std::acos(head.normalized().z()) - rad(kBy);
  Scene scene = sceneOf(body);
  scene.gravity.setZero();
  scene.solver.sleep = false;
  return scene;
}

TEST(StartPose, ARestPoseALittleOutsideIsCorrectedWithAWarning) {
  World world(restOutside());
  EXPECT_EQ(maxLimitViolation(world.model, world.state), 0);
  EXPECT_LT(maxStickError(world.model, world.state), 1e-6);
  ASSERT_EQ(world.model.warnings.size(), 1u);
  EXPECT_THAT(
      world.model.warnings[0],
      AllOf(HasSubstr("joint 'shoulder' 0.5 deg outside"), HasSubstr("joint 'elbow' 0.5 deg"),
            HasSubstr("joint 'neck' 0.5 deg"), HasSubstr("corrected, moved: ")));
  // Half a degree of the longest limb, and of what it is shared with.
  const Points& rest = world.model.skeletons[0].rest;
  EXPECT_LT((world.state.x - rest).colwise().norm().maxCoeff(), rad(0.6) * 0.7);
}

TEST(StartPose, ARestPoseALittleOutsideBringsNoEnergy) {
  for (const Method method : {Method::kJakobsen, Method::kShake, Method::kRk}) {
    Scene scene = restOutside();
    scene.solver.method = method;
    World world(scene);
    double energy = 0, outside = 0;
    for (int i = 0; i < 60; ++i) {
      world.steps(1);
      energy = std::max(energy, kineticEnergy(world.model, world.state));
      outside = std::max(outside, maxLimitViolation(world.model, world.state));
    }
    EXPECT_LT(energy, 1e-6) << static_cast<int>(method);  // all at 0.2 mm/s
    EXPECT_LT(deg(outside), 1e-3) << static_cast<int>(method);
  }
}

TEST(StartPose, ARestPoseThatNoPoseNearCorrectsIsRefused) {
  Scene scene = restOutside();
  SkeletonSpec body = *scene.ragdolls[0].skeleton;
  body.where = "limbs.yaml";
  // The elbow may not be straighter than half a degree, nor more bent than that.
  JointSpec other = cone("other", "upper_arm", "forearm", Vec3(0, 0, -1), 0.3);
  body.joints.push_back(other);
  scene.ragdolls[0].skeleton = std::make_shared<const SkeletonSpec>(body);
  EXPECT_THAT(errorOf([&] { buildModel(scene); }),
              AllOf(HasSubstr("limbs.yaml"), HasSubstr("joint 'elbow' 0.5 deg"),
                    HasSubstr("no pose near it")));
}

TEST(StartPose, PinsThatHoldItOutsideAreRefused) {
  Scene scene = armBentBack(40);
  scene.ragdolls[0].where = "ragdolls[0]";
  for (const char* name : {"hand", "elbow", "a", "b", "c"}) scene.pins.push_back(pinOf(name));
  // Arm and trunk are held where they are: nothing can be done.
  EXPECT_THAT(errorOf([&] { buildModel(scene); }),
              AllOf(HasSubstr("ragdolls[0].place"), HasSubstr("joint 'elbow' 40.0 deg"),
                    HasSubstr("the pins leave no way")));
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
  EXPECT_TRUE(untouched(armBentBack(5e-4)).empty());       // as figures in a file round
  EXPECT_TRUE(untouched(armBentBack(40, 1, 50)).empty());  // a spring presses it back
  const std::vector<std::string> apart = untouched(armBentBack(40, 2));
  ASSERT_EQ(apart.size(), 2u);
  EXPECT_THAT(apart[0], AllOf(HasSubstr("joint 'elbow' 40.0 deg outside"),
                              HasSubstr("sticks are off their lengths")));
  EXPECT_THAT(apart[1], HasSubstr("place leaves stick"));
}

}  // namespace
}  // namespace ragdoll
