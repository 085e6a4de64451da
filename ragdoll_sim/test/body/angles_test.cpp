#include "ragdoll_sim/body/angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "human_model.h"
#include "ragdoll_sim/body/part_motion.h"

namespace ragdoll::test {
namespace {

double valueOf(const JointAngles& angles, const Posture& posture, const std::string& name) {
  std::vector<double> values;
  angles.compute(posture, values);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (angles.names()[i] == name) return values[i];
  ADD_FAILURE() << "no joint angle " << name;
  return 0;
}

struct HumanWithAngles {
  Model model = modelOf(humanSkeleton());
  FrameTracker tracker{model};
  JointAngles angles{model, tracker};

  double angle(const std::map<std::string, Quat>& turns, const std::string& name) {
    tracker.reset(stateOf(posed(model.skeletons[0], turns, Vec3(1, 2, 3))));
    return valueOf(angles, tracker.now(), name);
  }
};

TEST(HingeAngle, IsTheRightHandTurn) {
  const Vec3 down = -Vec3::UnitZ();
  EXPECT_NEAR(hingeAngle(-Vec3::UnitY(), down, Vec3::UnitX()), M_PI / 2, 1e-15);
  EXPECT_NEAR(hingeAngle(Vec3::UnitY(), down, Vec3::UnitX()), -M_PI / 2, 1e-15);
  EXPECT_NEAR(hingeAngle(Vec3::UnitY(), down, down), 0, 1e-15);
}

TEST(HingeAngle, IgnoresWhatLiesAlongTheAxis) {
  const Vec3 child = Vec3(std::sin(0.7), 0.8, -std::cos(0.7)).normalized();
  EXPECT_NEAR(hingeAngle(-Vec3::UnitY(), -Vec3::UnitZ(), child), 0.7, 1e-12);
}

TEST(JointAngles, NamesFollowTheInterface) {
  const Model model = modelOf(humanSkeleton(), 2);
  const FrameTracker tracker(model);
  const JointAngles angles(model, tracker);
  const auto& names = angles.names();
  const auto has = [&](const std::string& n) {
    return std::count(names.begin(), names.end(), n) == 1;
  };
  for (const char* name : {"right_elbow_y", "left_knee_y", "neck_x", "neck_y", "neck_z",
                           "right_shoulder_x", "ragdoll1/right_elbow_y"})
    EXPECT_TRUE(has(name)) << name;
  EXPECT_FALSE(has("right_elbow_x"));
  EXPECT_FALSE(has("ragdoll/right_elbow_y"));
}

TEST(JointAngles, RestPoseIsZero) {
  HumanWithAngles human;
  human.tracker.reset(stateOf(human.model.skeletons[0].rest));
  std::vector<double> values;
  human.angles.compute(human.tracker.now(), values);
  ASSERT_EQ(values.size(), human.angles.names().size());
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_NEAR(values[i], 0, 1e-3) << human.angles.names()[i];
}

TEST(JointAngles, BentElbowAndKnee) {
  HumanWithAngles human;
  const Quat tilt = turn({1, 2, -1}, 2.2);  // wherever the body lies
  for (const double bend : {0.1, 0.5, 1.0, 1.7, 2.3}) {
    EXPECT_NEAR(
        human.angle({{"pelvis", tilt}, {"right_elbow", turn({0, -1, 0}, bend)}}, "right_elbow_y"),
        bend, 1e-3);
    EXPECT_NEAR(
        human.angle({{"pelvis", tilt}, {"left_knee", turn({0, 1, 0}, bend)}}, "left_knee_y"), bend,
        1e-9);
  }
}

TEST(JointAngles, BentElbowOfATurnedArm) {
  HumanWithAngles human;
  const Quat shoulder = turn({0, -1, 0}, 1.2) * turn({1, 0, 0}, 0.5) * turn({0, 0, 1}, 0.6);
  EXPECT_NEAR(human.angle({{"left_shoulder", shoulder}, {"left_elbow", turn({0, -1, 0}, 1.4)}},
                          "left_elbow_y"),
              1.4, 1e-3);
}

TEST(JointAngles, KneeBentTheWrongWayIsNegative) {
  HumanWithAngles human;
  EXPECT_NEAR(human.angle({{"left_knee", turn({0, 1, 0}, -0.6)}}, "left_knee_y"), -0.6, 1e-9);
}

TEST(JointAngles, ShoulderGivesItsEulerAngles) {
  HumanWithAngles human;
  const Vec3 xyz(-0.5, -0.8, 0.3);
  const std::map<std::string, Quat> turns = {{"right_shoulder", fromJointEuler(xyz)},
                                             {"right_elbow", turn({0, -1, 0}, 1.3)},
                                             {"pelvis", turn({1, 1, 0}, 1)}};
  EXPECT_NEAR(human.angle(turns, "right_shoulder_x"), xyz.x(), 1e-3);
  EXPECT_NEAR(human.angle(turns, "right_shoulder_y"), xyz.y(), 1e-3);
  EXPECT_NEAR(human.angle(turns, "right_shoulder_z"), xyz.z(), 1e-3);
}

TEST(JointEuler, RoundTrip) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 xyz(1.57 * uniform(random), 3.14 * uniform(random), 3.14 * uniform(random));
    EXPECT_LT((jointEuler(fromJointEuler(xyz)) - xyz).norm(), 1e-9);
  }
  EXPECT_NEAR(jointEuler(fromJointEuler({0, 0.4, 0})).y(), 0.4, 1e-12);
  // Locked: the turn is still right.
  const Quat locked = fromJointEuler({M_PI / 2, 0.3, 0.2});
  EXPECT_LT(angleOf(fromJointEuler(jointEuler(locked)).conjugate() * locked), 1e-6);
}

TEST(JointAngles, HingeBetweenGroups) {
  HumanWithAngles human;
  EXPECT_NEAR(
      human.angle({{"pelvis", turn({1, 2, -1}, 2.2)}, {"torso", turn({0, 1, 0}, 0.4)}}, "hips_y"),
      0.4, 1e-9);  // the pelvis turns by -0.4 about +y in the torso: by 0.4 about -y
}

}  // namespace
}  // namespace ragdoll::test
