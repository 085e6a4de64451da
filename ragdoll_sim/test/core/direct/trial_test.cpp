#include "core/direct/trial.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/constants.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

Scene fallOnto(double gap) {
  Scene scene = weightless(oneStick(1, 1, 0.05), Vec3(0, 0, -6));
  scene.ragdolls[0].pose.position.z() = 0.05 + gap;
  scene.obstacles = {floorPlane(0, 0.5)};
  return scene;
}

TEST(Trial, TakesTheWholeStepInTheAir) {
  DirectIsland one(fallOnto(1));
  const Trial trial = takeExplicitTrial(one.island, one.h);
  EXPECT_TRUE(trial.ok);
  EXPECT_DOUBLE_EQ(trial.took, one.h);
  EXPECT_NEAR(one.world.x(0).z(), 1.05 - 6 * one.h, 1e-12);
}

TEST(Trial, EndsAtTheImpact) {
  DirectIsland one(fallOnto(0.03));
  const Trial trial = takeExplicitTrial(one.island, one.h);
  EXPECT_TRUE(trial.ok);
  EXPECT_NEAR(trial.took, 0.005, 1e-9);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(one.world.x(i).z(), 0.05, 1e-8);
    EXPECT_NEAR(one.world.v(i).z(), 3, 1e-8);
  }
}

/// A rod that turns by sin(phi) = h omega in a step of SHAKE moves by 2 r sin(phi / 2); its velocities
/// are omega r along both ends of that turn.
TEST(Trial, TellsInAPartOfAStepHowFarItIsFromTheTrapezoidalRule) {
  constexpr double kSpin = 12, kRadius = 0.5;
  Scene scene = weightless(oneStick());
  scene.ragdolls[0].angular_velocity = Vec3(0, 0, kSpin);
  const auto defect = [&](bool part) {
    DirectIsland one(scene);
    one.context.whole = part ? 2 * one.h : 0;
    save(one.island);
    return takeExplicitTrial(one.island, one.h).defect;
  };
  const double turn = std::asin(kSpin * scene.solver.step);
  EXPECT_NEAR(defect(true), 2 * kRadius * std::pow(std::sin(0.5 * turn), 3), 1e-9);
  EXPECT_EQ(defect(false), 0);
}

/// What an impact changes of the velocities is no error of the motion to it.
TEST(Trial, TellsNoErrorOfAnImpact) {
  DirectIsland one(fallOnto(0.03));
  one.context.whole = 2 * one.h;
  save(one.island);
  EXPECT_LT(takeExplicitTrial(one.island, one.h).defect, 1e-9);
}

/// Half of what decays in the motion before it, half after it.
TEST(Trial, DampsAtBothEndsOfTheMotion) {
  Scene scene = weightless(oneParticle(2));
  scene.ragdolls[0].velocity.x() = 3;
  scene.solver.damping = 4;
  DirectIsland one(scene);
  takeExplicitTrial(one.island, one.h);
  EXPECT_NEAR(one.world.x(0).x(), 3 * std::exp(-2 * one.h) * one.h, 1e-14);
  EXPECT_NEAR(one.world.v(0).x(), 3 * std::exp(-4 * one.h), 1e-14);
}

TEST(Trial, IsTakenTheWayTheControlSays) {
  DirectIsland one(fallOnto(1));
  SubstepControl control(one.island, one.h);
  const auto countImplicit = [&] {
    one.report.implicit = 0;
    save(one.island);
    takeTrial(one.island, control, one.report);
    restore(one.island);
    return one.report.implicit;
  };
  EXPECT_EQ(countImplicit(), 0);
  while (control.way() == SubstepControl::Way::kExplicit) control.retry();
  EXPECT_EQ(countImplicit(), 1);
}

}  // namespace
}  // namespace ragdoll
