// ragdoll_lab crowd counts, keeps its bodies whole, and says what is wrong with its words.
#ifdef RAGDOLL_LAB

#include <gmock/gmock.h>

#include <cstdio>

#include "support/lab_program.h"

namespace ragdoll {
namespace {

using test::Outcome;
using ::testing::HasSubstr;

class LabCrowd : public test::LabProgram {
 protected:
  /// The two figures of a line of the table.
  static std::pair<double, double> figures(const Outcome& outcome, const std::string& line) {
    const std::size_t at = outcome.output.find(line);
    double one = -1, all = -1;
    if (at != std::string::npos)
      std::sscanf(outcome.output.c_str() + at + line.size(), "%lf %lf", &one, &all);
    return {one, all};
  }
};

TEST_F(LabCrowd, TellsWhatABodyCostsAloneAndAmongMany) {
  const Outcome outcome = lab("crowd 5 --seconds 0.5 --set solver.step=0.01");
  ASSERT_EQ(outcome.status, 0) << outcome.errors;
  EXPECT_EQ(figures(outcome, "bodies"), std::pair(1.0, 5.0));
  const auto cost = figures(outcome, "CPU time per body and step [us]");
  const auto speed = figures(outcome, "simulated per CPU second [s]");
  // Two ways to say the same: a step of 0.01 s costs that many bodies' steps.
  EXPECT_NEAR(speed.first * cost.first * 1e-6, 0.01, 2e-4);
  EXPECT_NEAR(speed.second * cost.second * 1e-6 * 5, 0.01, 2e-4);
  // All bodies do the same, at other places.
  const auto stretch = figures(outcome, "stick error at the end");
  EXPECT_GE(stretch.first, 0);
  EXPECT_LT(stretch.first, 1e-9);
  EXPECT_LT(stretch.second, 1e-9);
}

TEST_F(LabCrowd, SaysWhatIsWrong) {
  for (const std::string n : {"0", "-3", "many", "1e9", "7x", "100001"}) {
    const Outcome outcome = lab("crowd -- " + n);
    EXPECT_EQ(outcome.status, 2) << n;
    EXPECT_THAT(outcome.errors, HasSubstr("1 ... 10000")) << n;
  }
  EXPECT_THAT(lab("crowd 2 --model giant").errors, HasSubstr("giant"));
  EXPECT_EQ(lab("crowd 2 --seconds nan").status, 2);
  const Outcome huge = lab("crowd 2 --seconds 1e300");
  EXPECT_EQ(huge.status, 2);
  EXPECT_THAT(huge.errors, HasSubstr("--seconds: is 1e+300 s, more than 1e9 steps"));
  EXPECT_EQ(lab("crowd 2 --set solver.step=0").status, 2);
  EXPECT_EQ(lab("crowd").status, 2);
}

}  // namespace
}  // namespace ragdoll

#endif  // RAGDOLL_LAB
