// models/human_lumped.yaml: masses at its particles.
#include "human_body.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/start_state.h"

namespace ragdoll {
namespace {

using namespace test;

class HumanLumped : public ::testing::Test, protected HumanBody {
 protected:
  HumanLumped() : HumanBody("human_lumped") {}
};

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

TEST_F(HumanLumped, BalancesWhereTheTableSays) {
  const Vec3 centre = centreOfMass(model, startState(model), 0);
  const double trunk = 0.4346 * (1 - 0.4310) * 0.5155;
  EXPECT_NEAR(centre.z() - at("left_leg").z(), expectedHeight(trunk, std::cos(15 * M_PI / 180)),
              kDigits);
  EXPECT_NEAR(centre.x(), at("left_leg").x(), kDigits);
  EXPECT_NEAR(centre.y(), 0, 1e-15);
  // The trunk's lies on the line from the hip joints to the shoulders, in depth as well.
  const double trunk_depth =
      mass("neck") * at("neck").x() +
      2 * (mass("left_shoulder") - 0.0271 * (1 - 0.5772) * kMass) * at("left_shoulder").x() +
      2 * mass("left_hip") * at("left_hip").x();
  EXPECT_NEAR(trunk_depth / (0.4346 * kMass), at("left_leg").x(), kDigits);
}

}  // namespace
}  // namespace ragdoll
