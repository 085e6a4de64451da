// models/human_lumped.yaml against de Leva's table 4 (males), written down here a second time.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

constexpr double kScale = 1.75 / 1.741;  ///< statures
constexpr double kMass = 75;             ///< [kg]
constexpr double kDigits = 1e-4;         ///< [m], [kg] the file's last digit

class HumanLumped : public ::testing::Test {
 protected:
  Vec3 at(const std::string& particle) const {
    return skeleton.rest.col(skeleton.particle(particle));
  }
  double length(const std::string& a, const std::string& b) const { return (at(a) - at(b)).norm(); }
  double mass(const std::string& particle) const {
    return skeleton.M(skeleton.particle(particle), skeleton.particle(particle));
  }

  const Model model = buildModel(parseScene("ragdolls: [{model: human_lumped}]"));
  const Skeleton& skeleton = model.skeletons[0];
};

TEST_F(HumanLumped, IsTheThesisBody) {
  const std::set<std::string> expected = {
      "head",           "neck",        "left_shoulder", "left_elbow", "left_hand", "left_hip",
      "left_leg",       "left_knee",   "left_foot",     "right_hip",  "right_leg", "right_knee",
      "right_shoulder", "right_elbow", "right_hand",    "right_foot"};
  EXPECT_EQ(std::set<std::string>(skeleton.particles.begin(), skeleton.particles.end()), expected);
  EXPECT_EQ(skeleton.particles.size(), 16u);
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

TEST_F(HumanLumped, StandsAboutTheMidpointOfItsHips) {
  EXPECT_EQ(at("left_hip") + at("right_hip"), Vec3(0, 0, 0));
  EXPECT_GT(at("left_hip").y(), 0);
  EXPECT_GT(at("head").z(), at("neck").z());
  EXPECT_LT(at("neck").x(), at("head").x()) << "faces +x";
  for (const std::string part : {"shoulder", "elbow", "hand", "hip", "leg", "knee", "foot"}) {
    const Vec3 left = at("left_" + part), right = at("right_" + part);
    EXPECT_EQ(left, Vec3(right.x(), -right.y(), right.z())) << part;
    EXPECT_EQ(mass("left_" + part), mass("right_" + part)) << part;
  }
  EXPECT_EQ(at("neck").y(), 0);
  EXPECT_EQ(at("head").y(), 0);
}

TEST_F(HumanLumped, HasTheLengthsOfTheTable) {
  EXPECT_NEAR(length("left_shoulder", "left_elbow"), 0.2817 * kScale, kDigits);
  EXPECT_NEAR(length("left_elbow", "left_hand"), (0.2689 + 0.79 * 0.0862) * kScale, kDigits);
  EXPECT_NEAR(length("left_leg", "left_knee"), 0.4222 * kScale, kDigits);
  EXPECT_NEAR(length("left_knee", "left_foot"), 0.4403 * kScale + 0.035, kDigits);
  EXPECT_NEAR(at("left_shoulder").z() - at("left_leg").z(), 0.5155 * kScale, kDigits);
  EXPECT_NEAR(at("neck").z() - at("left_leg").z(), 0.6033 * kScale, kDigits);
  EXPECT_NEAR(at("head").z() - at("neck").z(), (1 - 0.5002) * 0.2429 * kScale, kDigits);
}

TEST_F(HumanLumped, KneesAndElbowsAreStraight) {
  const auto bend = [&](const char* a, const char* b, const char* c) {
    return (at(b) - at(a)).normalized().cross((at(c) - at(b)).normalized()).norm();
  };
  EXPECT_LT(bend("left_shoulder", "left_elbow", "left_hand"), 1e-3);
  EXPECT_LT(bend("left_leg", "left_knee", "left_foot"), 1e-12);
}

TEST_F(HumanLumped, WeighsWhatTheTableSays) {
  EXPECT_NEAR(skeleton.M.trace(), kMass, 1e-9);
  const double trunk = mass("neck") + 2 * mass("left_shoulder") + 2 * mass("left_hip") -
                       2 * 0.0271 * (1 - 0.5772) * kMass;
  EXPECT_NEAR(trunk, 0.4346 * kMass, 5 * kDigits);
  EXPECT_NEAR(mass("head"), 0.0694 * kMass, kDigits);
  EXPECT_NEAR(mass("left_leg"), 0.1416 * (1 - 0.4095) * kMass, kDigits);
  EXPECT_NEAR(mass("left_leg") + mass("left_knee") + mass("left_foot"),
              (0.1416 + 0.0433 + 0.0137) * kMass, 3 * kDigits);
  EXPECT_NEAR(mass("left_elbow") + mass("left_hand"), (0.0271 * 0.5772 + 0.0162 + 0.0061) * kMass,
              2 * kDigits);
}

/// Height of the centre of mass over the hip joint centres, from the table's segments alone.
double expectedHeight(double arm_slope) {
  const double trunk = 0.4346 * (1 - 0.4310) * 0.5155;
  const double head = 0.0694 * (0.6033 + (1 - 0.5002) * 0.2429);
  const double arm = (0.0271 + 0.0162 + 0.0061) * 0.5155 -
                     arm_slope * (0.0271 * 0.5772 * 0.2817 + 0.0162 * (0.2817 + 0.4574 * 0.2689) +
                                  0.0061 * (0.2817 + 0.2689 + 0.79 * 0.0862));
  const double foot_below_ankle = 0.035 / kScale;
  const double leg = 0.1416 * 0.4095 * 0.4222 + 0.0433 * (0.4222 + 0.4395 * 0.4403) +
                     0.0137 * (0.4222 + 0.4403 + foot_below_ankle);
  return kScale * (trunk + head + 2 * arm - 2 * leg);
}

TEST_F(HumanLumped, BalancesWhereTheTableSays) {
  const Vec3 centre = centreOfMass(model, startState(model), 0);
  EXPECT_NEAR(centre.z() - at("left_leg").z(), expectedHeight(std::cos(15 * M_PI / 180)), kDigits);
  EXPECT_NEAR(centre.y(), 0, 1e-15);
  // The trunk's lies on the line from the hip joints to the shoulders, in depth as well.
  const double trunk_depth =
      mass("neck") * at("neck").x() +
      2 * (mass("left_shoulder") - 0.0271 * (1 - 0.5772) * kMass) * at("left_shoulder").x() +
      2 * mass("left_hip") * at("left_hip").x();
  EXPECT_NEAR(trunk_depth / (0.4346 * kMass), at("left_leg").x(), kDigits);
}

TEST_F(HumanLumped, EveryBoneHasAName) {
  for (const std::string name :
       {"torso", "pelvis", "head", "left_upper_arm", "left_forearm", "left_thigh", "left_shank",
        "right_upper_arm", "right_forearm", "right_thigh", "right_shank"}) {
    EXPECT_GE(skeleton.segment(name), 0) << name;
    EXPECT_NO_THROW(findBody(model, name)) << name;
  }
  EXPECT_EQ(skeleton.segments.size(), 11u);
}

}  // namespace
}  // namespace ragdoll
