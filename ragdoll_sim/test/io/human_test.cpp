// models/human.yaml: masses and inertia of its segments.
#include "human_body.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/start_state.h"

namespace ragdoll {
namespace {

using namespace test;

class Human : public ::testing::Test, protected HumanBody {
 protected:
  Human() : HumanBody("human") {}
};

/// Mass of a limb and all beyond it, from how it carries a motion of its own particles.
TEST_F(Human, WeighsWhatTheTableSays) {
  EXPECT_EQ(skeleton.size(), 17) << "one more than named carries the flat pelvis's inertia";
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

/// The trunk in three parts.
TEST_F(Human, BalancesWhereTheTableSays) {
  const Vec3 centre = centreOfMass(model, startState(model), 0);
  const double trunk = 0.1117 * (1 - 0.6115) * 0.1457 + 0.1633 * (0.1457 + (1 - 0.4502) * 0.2155) +
                       0.1596 * (0.1457 + 0.2155 + (1 - 0.2999) * 0.1707);
  EXPECT_NEAR(centre.z() - at("left_leg").z(), expectedHeight(trunk, std::cos(15 * M_PI / 180)),
              kDigits);
  // The table's centres of mass lie on the lines from joint to joint, which stand in one plane.
  EXPECT_NEAR(centre.x(), at("left_leg").x(), kDigits);
  EXPECT_NEAR(centre.y(), 0, 1e-15);
}

}  // namespace
}  // namespace ragdoll
