#include "ragdoll_sim/core/solver_presets.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/core/error.h"

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

TEST(SolverPresets, AnUnknownNameIsToldWithTheKnownOnes) {
  try {
    preset("best");
    FAIL();
  } catch (const Error& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find("'best'"), std::string::npos) << what;
    for (const std::string& name : presetNames())
      EXPECT_NE(what.find(name), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace ragdoll
