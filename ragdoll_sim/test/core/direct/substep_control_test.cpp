#include "core/direct/substep_control.h"

#include <gtest/gtest.h>

#include "core/direct/constants.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;
using Way = SubstepControl::Way;

TEST(SubstepControl, TakesWhatTheTensionAllows) {
  DirectIsland one(weightless(oneStick()));
  EXPECT_EQ(SubstepControl(one.island, one.h).substep(), one.h);
  // Of two particles of 1 kg Omega^2 is 4 |m|: here h Omega = 2.5.
  one.body().multipliers()[0] = -2.5 * 2.5 / (4 * one.h * one.h);
  SubstepControl control(one.island, one.h);
  EXPECT_DOUBLE_EQ(control.substep(), one.h / 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(control.done());
    control.accept(control.substep(), false);
  }
  EXPECT_TRUE(control.done());
}

TEST(SubstepControl, TellsWhoseEnergyWasTakenOut) {
  DirectIsland one(weightless(oneStick()));
  SubstepControl control(one.island, one.h);
  StepReport report;
  control.accept(0.5 * one.h, false);
  control.tell(report);
  EXPECT_EQ(report.limited, 0);
  control.accept(0.25 * one.h, true);
  control.accept(0.25 * one.h, false);  // once is enough
  EXPECT_TRUE(control.limited());
  control.tell(report);
  EXPECT_EQ(report.limited, 1);
}

/// The table of substep_control.h.
TEST(SubstepControl, GoesFromExplicitToImplicitToRigid) {
  DirectIsland one(weightless(oneStick()));
  SubstepControl control(one.island, one.h);
  double least = one.h;
  for (; control.way() == Way::kExplicit; control.retry()) least = control.substep();
  EXPECT_DOUBLE_EQ(least, one.h / kMaxSubsteps);
  EXPECT_EQ(control.way(), Way::kImplicit);
  EXPECT_EQ(control.substep(), one.h);  // over all that is left
  for (; control.way() == Way::kImplicit; control.retry()) least = control.substep();
  EXPECT_DOUBLE_EQ(least, one.h / kMaxImplicitSubsteps);
  EXPECT_EQ(control.way(), Way::kRigid);
  StepReport report;
  control.tell(report);
  EXPECT_EQ(report.guarded, 1);
}

}  // namespace
}  // namespace ragdoll
