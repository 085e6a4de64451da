#include "ragdoll_sim/core/solver_presets.h"

#include <gtest/gtest.h>

#include "support/error_of.h"

namespace ragdoll {
namespace {

TEST(SolverPresets, HaveTheirNameAndAnErrorUntilAKnobIsTurned) {
  ASSERT_FALSE(presetNames().empty());
  for (const std::string& name : presetNames()) {
    SolverSpec solver = preset(name);
    EXPECT_EQ(solver.preset, name);
    EXPECT_NE(errorClass(solver), "") << name;
    solver.step *= 0.5;
    EXPECT_EQ(errorClass(solver), "") << name;
  }
}

TEST(SolverPresets, OfTheThesisIsTheThesis) {
  const SolverSpec thesis = preset("thesis");
  EXPECT_EQ(thesis.method, Method::kJakobsen);
  EXPECT_EQ(thesis.integrator, Integrator::kVerlet);
  EXPECT_EQ(thesis.step, 1.0 / 60);
  EXPECT_EQ(thesis.sweeps, 10);
}

TEST(SolverPresets, AnUnknownNameIsToldWithTheKnownOnes) {
  const std::string what = test::errorOf([] { preset("best"); });
  EXPECT_NE(what.find("'best'"), std::string::npos) << what;
  for (const std::string& name : presetNames())
    EXPECT_NE(what.find(name), std::string::npos) << what;
}

}  // namespace
}  // namespace ragdoll
