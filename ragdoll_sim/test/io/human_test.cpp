// models/human.yaml against de Leva's table 4 (males), written down here a second time.
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

class Human : public ::testing::Test {
 protected:
  Vec3 at(const std::string& particle) const {
    return skeleton.rest.col(skeleton.particle(particle));
  }
  double length(const std::string& a, const std::string& b) const { return (at(a) - at(b)).norm(); }
  double mass(const std::string& particle) const {
    return skeleton.M(skeleton.particle(particle), skeleton.particle(particle));
  }

  const Model model = buildModel(parseScene("ragdolls: [{model: human}]"));
  const Skeleton& skeleton = model.skeletons[0];
};

TEST_F(Human, IsTheThesisBody) {
  const std::set<std::string> expected = {
      "head",           "neck",        "left_shoulder", "left_elbow", "left_hand", "left_hip",
      "left_leg",       "left_knee",   "left_foot",     "right_hip",  "right_leg", "right_knee",
      "right_shoulder", "right_elbow", "right_hand",    "right_foot"};
  const auto names = skeleton.particles.begin();
  EXPECT_EQ(std::set<std::string>(names, names + skeleton.named), expected);
  EXPECT_EQ(skeleton.named, 16);
  EXPECT_EQ(skeleton.size(), 17) << "one more carries the flat pelvis's inertia";
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

TEST_F(Human, StandsAboutTheMidpointOfItsHips) {
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

TEST_F(Human, HasTheLengthsOfTheTable) {
  EXPECT_NEAR(length("left_shoulder", "left_elbow"), 0.2817 * kScale, kDigits);
  EXPECT_NEAR(length("left_elbow", "left_hand"), (0.2689 + 0.79 * 0.0862) * kScale, kDigits);
  EXPECT_NEAR(length("left_leg", "left_knee"), 0.4222 * kScale, kDigits);
  EXPECT_NEAR(length("left_knee", "left_foot"), 0.4403 * kScale + 0.035, kDigits);
  EXPECT_NEAR(at("left_shoulder").z() - at("left_leg").z(), 0.5155 * kScale, kDigits);
  EXPECT_NEAR(at("neck").z() - at("left_leg").z(), 0.6033 * kScale, kDigits);
  EXPECT_NEAR(at("head").z() - at("neck").z(), (1 - 0.5002) * 0.2429 * kScale, kDigits);
}

TEST_F(Human, KneesAndElbowsAreStraight) {
  const auto bend = [&](const char* a, const char* b, const char* c) {
    return (at(b) - at(a)).normalized().cross((at(c) - at(b)).normalized()).norm();
  };
  EXPECT_LT(bend("left_shoulder", "left_elbow", "left_hand"), 1e-3);
  EXPECT_LT(bend("left_leg", "left_knee", "left_foot"), 1e-12);
}

/// Mass of a limb and all beyond it, from how it carries a motion of its own particles.
TEST_F(Human, WeighsWhatTheTableSays) {
  EXPECT_NEAR(skeleton.M.sum(), kMass, 1e-9);
  const auto share = [&](const std::vector<std::string>& particles) {
    double sum = 0;
    for (const std::string& a : particles)
      for (int b = 0; b < skeleton.size(); ++b) sum += skeleton.M(skeleton.particle(a), b);
    return sum;
  };
  // What a bone's ends stand for: forearm and hand, and the upper arm's share at the elbow.
  EXPECT_NEAR(share({"left_elbow", "left_hand"}), (0.0271 * 0.5772 + 0.0162 + 0.0061) * kMass,
              2 * kDigits);
  EXPECT_NEAR(share({"left_knee", "left_foot"}), (0.1416 * 0.4095 + 0.0433 + 0.0137) * kMass,
              3 * kDigits);
}

/// Moment of inertia about an axis through the centre of mass, from the mass matrix.
TEST_F(Human, TurnsAsItsSegmentsDo) {
  const State state = startState(model);
  const Vec3 centre = centreOfMass(model, state, 0);
  struct Part {
    double mass;
    Vec3 centre, inertia;  // principal about its centre, axes as the body's
  };
  // Table 4 again, scaled; rods have the mean of the two transverse radii and none about
  // themselves.
  const auto trunkPart = [](double mass, double top, double length, double com, const Vec3& radii) {
    const Vec3 k = radii * length * kScale;
    return Part{mass * kMass, Vec3(-0.01, 0, top - com * length * kScale),
                mass * kMass * k.cwiseAbs2()};
  };
  const double leg = at("left_leg").z(), navel = leg + 0.1457 * kScale,
               chest = navel + 0.2155 * kScale;
  const std::vector<Part> trunk = {
      trunkPart(0.1117, navel, 0.1457, 0.6115, Vec3(0.615, 0.551, 0.587)),
      trunkPart(0.1633, chest, 0.2155, 0.4502, Vec3(0.482, 0.383, 0.468)),
      trunkPart(0.1596, chest + 0.1707 * kScale, 0.1707, 0.2999, Vec3(0.716, 0.454, 0.659))};
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 w = Vec3::Unit(axis);
    double expected = 0;
    for (const Part& p : trunk)
      expected += p.inertia[axis] + p.mass * w.cross(p.centre - centre).squaredNorm();
    const auto rod = [&](const char* from, const char* to, double mass, double com,
                         double gyration) {
      const Vec3 d = at(to) - at(from);
      expected += mass * (w.cross(at(from) + com * d - centre).squaredNorm() +
                          gyration * gyration * w.cross(d).squaredNorm());
    };
    rod("neck", "head", 0.0694 * kMass, 1, 0.30906 * 0.2429 * kScale / length("neck", "head"));
    for (const std::string side : {"left_", "right_"}) {
      rod((side + "shoulder").c_str(), (side + "elbow").c_str(), 0.0271 * kMass, 0.5772, 0.2771);
      rod((side + "leg").c_str(), (side + "knee").c_str(), 0.1416 * kMass, 0.4095, 0.329);
      const double fore = length(side + "elbow", side + "hand"), l = 0.2689 * kScale / fore;
      rod((side + "elbow").c_str(), (side + "hand").c_str(), 0.0162 * kMass, 0.4574 * l,
          0.27056 * l);
      rod((side + "elbow").c_str(), (side + "hand").c_str(), 0.0061 * kMass, 1,
          0.57338 * 0.0862 * kScale / fore);
      const double low = length(side + "knee", side + "foot"), s = 0.4403 * kScale / low;
      rod((side + "knee").c_str(), (side + "foot").c_str(), 0.0433 * kMass, 0.4395 * s,
          0.24851 * s);
      rod((side + "knee").c_str(), (side + "foot").c_str(), 0.0137 * kMass, 1,
          0.2511 * 0.2581 * kScale / low);
    }
    Points v(3, skeleton.size());
    for (int i = 0; i < skeleton.size(); ++i)
      v.col(i) = w.cross(Vec3(skeleton.rest.col(i)) - centre);
    EXPECT_NEAR((v * skeleton.M).cwiseProduct(v).sum() / expected, 1, 1e-3) << "axis " << axis;
  }
}

/// Height of the centre of mass over the hip joint centres, from the table's segments alone.
double expectedHeight(double arm_slope) {
  const double trunk = 0.1117 * (1 - 0.6115) * 0.1457 +
                       0.1633 * (0.1457 + (1 - 0.4502) * 0.2155) +
                       0.1596 * (0.1457 + 0.2155 + (1 - 0.2999) * 0.1707);
  const double head = 0.0694 * (0.6033 + (1 - 0.5002) * 0.2429);
  const double arm = (0.0271 + 0.0162 + 0.0061) * 0.5155 -
                     arm_slope * (0.0271 * 0.5772 * 0.2817 + 0.0162 * (0.2817 + 0.4574 * 0.2689) +
                                  0.0061 * (0.2817 + 0.2689 + 0.79 * 0.0862));
  const double foot_below_ankle = 0.035 / kScale;
  const double leg = 0.1416 * 0.4095 * 0.4222 + 0.0433 * (0.4222 + 0.4395 * 0.4403) +
                     0.0137 * (0.4222 + 0.4403 + foot_below_ankle);
  return kScale * (trunk + head + 2 * arm - 2 * leg);
}

TEST_F(Human, BalancesWhereTheTableSays) {
  const Vec3 centre = centreOfMass(model, startState(model), 0);
  EXPECT_NEAR(centre.z() - at("left_leg").z(), expectedHeight(std::cos(15 * M_PI / 180)), kDigits);
  EXPECT_NEAR(centre.y(), 0, 1e-15);
}

TEST_F(Human, EveryBoneHasAName) {
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
