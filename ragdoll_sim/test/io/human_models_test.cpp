// What the shipped humans have in common: particles, sticks, lengths and names.
#include <map>
#include <set>

#include "human_body.h"

namespace ragdoll {
namespace {

using namespace test;

class AnyHuman : public ::testing::TestWithParam<const char*>, protected HumanBody {
 protected:
  AnyHuman() : HumanBody(GetParam()) {}
};

INSTANTIATE_TEST_SUITE_P(Models, AnyHuman,
                         ::testing::Values("human", "human_lumped", "human_thesis"));

TEST_P(AnyHuman, IsTheThesisBody) {
  const std::set<std::string> expected = {
      "head",           "neck",        "left_shoulder", "left_elbow", "left_hand", "left_hip",
      "left_leg",       "left_knee",   "left_foot",     "right_hip",  "right_leg", "right_knee",
      "right_shoulder", "right_elbow", "right_hand",    "right_foot"};
  const auto names = skeleton.particles.begin();
  EXPECT_EQ(std::set<std::string>(names, names + skeleton.named), expected);
  EXPECT_EQ(skeleton.named, 16);
  EXPECT_EQ(skeleton.sticks.size(), 24u);

  std::map<std::string, int> degree;
  for (const Stick& stick : skeleton.sticks) {
    ++degree[skeleton.particles[stick.a]];
    ++degree[skeleton.particles[stick.b]];
  }
  EXPECT_EQ(degree["neck"], 5);           // four of the torso, the head
  EXPECT_EQ(degree["left_shoulder"], 5);  // four of the torso, the arm
  EXPECT_EQ(degree["left_hip"], 6);       // four of the torso, two legs
  EXPECT_EQ(degree["left_leg"], 4);       // three of the pelvis, the thigh
  EXPECT_EQ(degree["left_knee"], 2);
  EXPECT_EQ(degree["left_hand"], 1);
}

TEST_P(AnyHuman, StandsAboutTheMidpointOfItsHips) {
  EXPECT_EQ(at("left_hip") + at("right_hip"), Vec3(0, 0, 0));
  EXPECT_GT(at("left_hip").y(), 0);
  EXPECT_GT(at("head").z(), at("neck").z());
  EXPECT_LT(at("neck").x(), at("head").x()) << "faces +x";
  for (const std::string part : {"shoulder", "elbow", "hand", "hip", "leg", "knee", "foot"}) {
    const Vec3 left = at("left_" + part), right = at("right_" + part);
    EXPECT_EQ(left, Vec3(right.x(), -right.y(), right.z())) << part;
    EXPECT_NEAR(mass("left_" + part), mass("right_" + part), 1e-9) << part;
  }
  EXPECT_EQ(at("neck").y(), 0);
  EXPECT_EQ(at("head").y(), 0);
}

TEST_P(AnyHuman, HasTheLengthsOfTheTable) {
  EXPECT_NEAR(length("left_shoulder", "left_elbow"), 0.2817 * kScale, kDigits);
  EXPECT_NEAR(length("left_elbow", "left_hand"), (0.2689 + 0.79 * 0.0862) * kScale, kDigits);
  EXPECT_NEAR(length("left_leg", "left_knee"), 0.4222 * kScale, kDigits);
  EXPECT_NEAR(length("left_knee", "left_foot"), 0.4403 * kScale + 0.035, kDigits);
  EXPECT_NEAR(at("left_shoulder").z() - at("left_leg").z(), 0.5155 * kScale, kDigits);
  EXPECT_NEAR(at("neck").z() - at("left_leg").z(), 0.6033 * kScale, kDigits);
  EXPECT_NEAR(at("head").z() - at("neck").z(), (1 - 0.5002) * 0.2429 * kScale, kDigits);
}

TEST_P(AnyHuman, KneesAndElbowsAreStraight) {
  const auto bend = [&](const char* a, const char* b, const char* c) {
    return (at(b) - at(a)).normalized().cross((at(c) - at(b)).normalized()).norm();
  };
  // The thesis's elbow is never straighter than 10 degrees in the sagittal plane, to which the arm
  // hangs at 15; its knee is bent by 8.
  const bool thesis = GetParam() == std::string("human_thesis");
  const double arm = 15 * M_PI / 180, knee = 8 * M_PI / 180;
  EXPECT_NEAR(bend("left_shoulder", "left_elbow", "left_hand"),
              thesis ? std::sin(arm) * std::cos(arm) : 0, 1e-3);
  EXPECT_NEAR(bend("left_leg", "left_knee", "left_foot"), thesis ? std::sin(knee) : 0,
              thesis ? 1e-3 : 1e-12);
}

TEST_P(AnyHuman, EveryBoneHasAName) {
  for (const std::string name :
       {"torso", "pelvis", "head", "left_upper_arm", "left_forearm", "left_thigh", "left_shank",
        "right_upper_arm", "right_forearm", "right_thigh", "right_shank"}) {
    EXPECT_GE(skeleton.segment(name), 0) << name;
    EXPECT_NO_THROW(findBody(model, name)) << name;
  }
}

}  // namespace
}  // namespace ragdoll
