// What the checks of a model's joints refuse, and what they tell.
#include "core/loading/joint_checks.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/core/build_model.h"
#include "support/error_of.h"
#include "support/limbs.h"

namespace ragdoll {
namespace {

using namespace test;

std::string faultOf(const SkeletonSpec& s) {
  return errorOf([&] { buildModel(sceneOf(s)); });
}

std::string faultOf(const JointSpec& joint) {
  SkeletonSpec s = limbs();
  s.joints = {joint};
  return faultOf(s);
}

TEST(LimitChecks, NameTheJointAndWhatIsWrong) {
  const auto says = [](const JointSpec& j, const std::string& text) {
    EXPECT_NE(faultOf(j).find(text), std::string::npos) << "'" << faultOf(j) << "' lacks " << text;
    EXPECT_EQ(faultOf(j).find("joints." + j.name), 0u) << faultOf(j);
  };
  const Vec3 y = Vec3::UnitY();
  says(hinge("j", "upper_arm", "forearm", y, 20, 10), "range is 20.0 deg to 10.0 deg");
  says(hinge("j", "upper_arm", "forearm", y, -200, 10), "within (-180, 180] deg");
  says(cone("j", "trunk", "head", Vec3::UnitZ(), 0), "half angle is 0.0 deg");
  says(cone("j", "trunk", "head", Vec3::UnitZ(), 180), "it must be in (0, 180) deg");
  says(cone("j", "trunk", "palm", Vec3::UnitZ(), 40), "share no particle");
  says(hinge("j", "upper_arm", "forearm", Vec3::UnitZ(), 0, 10), "along the parent bone");
  says(cone("j", "forearm", "palm", Vec3::UnitX(), 100), "nothing shows how its parent");
  JointSpec twist = hinge("j", "upper_arm", "forearm", -y, 0, 145);
  twist.twist = rad(120);
  says(twist, "twist is 120.0 deg");
  JointSpec soft = cone("j", "trunk", "head", Vec3::UnitZ(), 60);
  soft.stiffness = -1;
  says(soft, "stiffness must be > 0");
  JointSpec region = planes("j", "trunk", "upper_arm");
  region.planes[0] = AngleRange{rad(50), rad(20)};
  says(region, "end above its begin");
}

TEST(LimitChecks, RefuseARestPoseOutsideItsLimits) {
  const std::string bend = faultOf(hinge("e", "upper_arm", "forearm", -Vec3::UnitY(), 10, 130));
  EXPECT_NE(
      bend.find("joints.e: joint 'e': the rest pose is 10.0 deg outside its limit, bent by 0.0 "
                "deg where 10.0 deg to 130.0 deg are allowed"),
      std::string::npos)
      << bend;
  const std::string tilt = faultOf(cone("n", "trunk", "head", -Vec3::UnitX(), 60));
  EXPECT_NE(tilt.find("90.0 deg off its axis where 0 to 60.0 deg are allowed"), std::string::npos)
      << tilt;
  JointSpec region = planes("p", "trunk", "upper_arm");
  region.planes[1] = AngleRange{rad(100), rad(225)};
  const std::string plane = faultOf(region);
  EXPECT_NE(plane.find("yz 90.0 deg where 100.0 deg to 225.0 deg are allowed"), std::string::npos)
      << plane;
}

/// Bent within its range, but sideways.
TEST(LimitChecks, NameTheTwistOfARestPoseOutOfTheHingesPlane) {
  SkeletonSpec s = limbs();
  for (ParticleSpec& p : s.particles)
    if (p.name == "hand") p.position = {0.06, -0.1, 0};
  s.joints = {hinge("e", "upper_arm", "forearm", -Vec3::UnitY(), 0, 145)};
  s.joints[0].twist = rad(20);
  const std::string fault = faultOf(s);
  EXPECT_NE(fault.find("deg where 0.0 deg to 145.0 deg are allowed, but farther out of the hinge's "
                       "plane than twist_deg (20.0 deg) allows"),
            std::string::npos)
      << fault;
}

TEST(LimitChecks, WarnOfARestPoseALittleOutside) {
  SkeletonSpec s = limbs();
  s.joints = {hinge("e", "upper_arm", "forearm", -Vec3::UnitY(), 0.5, 130)};
  const Model model = buildModel(sceneOf(s));
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_NE(model.warnings[0].find("joint 'e' 0.5 deg outside its limit"), std::string::npos)
      << model.warnings[0];
}

TEST(LimitChecks, WarnOfAHingeWhoseDirectionNothingShows) {
  SkeletonSpec s;
  s.particles = {particle("a", {0, 0, 0}), particle("b", {0, 0, -1}), particle("c", {0, 0, -2})};
  s.sticks = {stick("a", "b"), stick("b", "c")};
  s.segments = {bone("ab", "a", "b"), bone("bc", "b", "c")};
  s.joints = {hinge("b", "ab", "bc", Vec3::UnitY(), 0, 90)};
  const Model model = buildModel(sceneOf(s));
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_NE(model.warnings[0].find("to any side"), std::string::npos);
  EXPECT_EQ(model.skeletons[0].limits.size(), 1u);
}

}  // namespace
}  // namespace ragdoll
