#include "core/direct/error_control.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/constants.h"

namespace ragdoll {
namespace {

constexpr double kWholeStep = 0.1;   ///< [s]
constexpr double kTolerance = 1e-4;  ///< [m/s]

/// Parts and tries that a step takes if a part's error [m] is error(from, part).
struct Taken {
  int parts = 0, tries = 0;
  double error = 0, end = 0, next = 0;
  StepReport report;
};

template <typename Error>
Taken take(const Error& error, int order, double next = 0) {
  Taken taken;
  taken.next = next;
  ErrorControl control(kWholeStep, kTolerance, taken.next);
  while (!control.done() && taken.tries < 10000) {
    const double made = error(control.from(), control.part());
    const double end = control.from() + control.part();
    ++taken.tries;
    if (!control.accepts(made, order)) continue;
    ++taken.parts;
    taken.error += made;
    taken.end = end;
  }
  control.tell(3, taken.report);
  return taken;
}

TEST(ErrorControl, OfASmoothMotionKeepsTheErrorPerSecond) {
  for (const int order : {2, 4})
    for (const double next : {0.0, 1e-5, 1e-3}) {
      const auto error = [&](double, double part) { return std::pow(part, order + 1); };
      const Taken taken = take(error, order, next);
      EXPECT_NEAR(taken.end, kWholeStep, 1e-12);
      EXPECT_LE(taken.error, kTolerance * kWholeStep);
      // Parts that aim at what is reserved for each of them: no more work than asked for.
      const double aimed = std::pow(kAim * kReserved * kTolerance, 1.0 / order);
      EXPECT_LE(taken.parts, std::ceil(kWholeStep / aimed) + 8);
      EXPECT_GT(taken.next, 0.9 * aimed);
      EXPECT_EQ(taken.report.tolerance_missed, 0);
      EXPECT_EQ(taken.report.substeps, taken.parts);
      EXPECT_GT(taken.report.error_estimate, 0);
      EXPECT_LE(taken.report.error_estimate, kTolerance);
    }
}

/// A method that takes all that is left is held to what is left.
TEST(ErrorControl, TakesTheRestAtOnce) {
  for (const double share : {0.9, 1.1}) {
    double next = kWholeStep / 4;
    ErrorControl control(kWholeStep, kTolerance, next);
    EXPECT_EQ(control.left(), kWholeStep);
    ASSERT_TRUE(control.accepts(0, 2));
    EXPECT_NEAR(control.left(), 0.75 * kWholeStep, 1e-15);
    control.takeRest(share * 0.75 * kWholeStep * kTolerance);
    EXPECT_TRUE(control.done());
    StepReport report;
    control.tell(3, report);
    EXPECT_EQ(report.substeps, 2);
    EXPECT_NEAR(report.error_estimate, 0.75 * share * kTolerance, 1e-15);
    EXPECT_EQ(report.tolerance_missed, share > 1 ? 3 : 0);
  }
}

TEST(ErrorControl, PassesAJumpAndTellsSo) {
  const auto jump = [](double from, double part) {
    return from <= 0.03 && from + part > 0.03 ? 1e-3 : 0.0;
  };
  const Taken taken = take(jump, 2);
  EXPECT_NEAR(taken.end, kWholeStep, 1e-12);
  EXPECT_LT(taken.tries, 40);
  EXPECT_EQ(taken.report.tolerance_missed, 3);
  EXPECT_GT(taken.report.error_estimate, kTolerance);
}

/// Behind what shorter parts do not help with the motion is as any other.
TEST(ErrorControl, KeepsWhatFollowsAJump) {
  for (const double rough : {3.0, 100.0, 300.0}) {  // [m/s^3]
    const auto error = [&](double from, double part) {
      return rough * std::pow(part, 3) + (from <= 0.001 && from + part > 0.001 ? 1e-3 : 0.0);
    };
    const Taken taken = take(error, 2);
    EXPECT_NEAR(taken.end, kWholeStep, 1e-12);
    EXPECT_LE(taken.error - 1e-3, kTolerance * kWholeStep) << rough;
    EXPECT_EQ(taken.report.tolerance_missed, 3);
  }
}

TEST(ErrorControl, LetsOneEventHaveWhatThePartsThatFollowDoNotNeed) {
  const auto small = [](double from, double part) {
    return from <= 0.03 && from + part > 0.03 ? 0.4 * kTolerance * kWholeStep : 0.0;
  };
  const Taken taken = take(small, 2, 0.01);
  EXPECT_EQ(taken.tries, taken.parts);
  EXPECT_EQ(taken.report.tolerance_missed, 0);
  EXPECT_NEAR(taken.report.error_estimate, 0.4 * kTolerance, 1e-12);
}

TEST(ErrorControl, DoesNotGoOnTryingWhatIsInVain) {
  const auto same = [](double, double part) { return 1.0 * part; };
  const auto unknown = [](double, double) { return kUnknownRate; };
  EXPECT_LT(take(same, 2).tries, 12);
  EXPECT_LT(take(unknown, 2).tries, 16);
  EXPECT_EQ(take(same, 2).report.tolerance_missed, 3);
}

/// What helps, but not enough: parts down to the shortest, and the tries to get there.
TEST(ErrorControl, IsBoundInWork) {
  const double shortest = kShortestPart * std::sqrt(kTolerance);
  const auto stiff = [](double, double part) { return 1e6 * std::pow(part, 3); };
  const Taken taken = take(stiff, 2);
  EXPECT_NEAR(taken.end, kWholeStep, 1e-12);
  EXPECT_LT(taken.tries, 3 * kWholeStep / shortest);
  EXPECT_EQ(taken.report.tolerance_missed, 3);
}

TEST(ErrorControl, TakesAMotionThatIsNotFoundForAnError) {
  const auto none = [](double from, double part) {
    return from + part < 0.05 ? 0.0 : kUnknownRate;
  };
  const Taken taken = take(none, 4);
  EXPECT_NEAR(taken.end, kWholeStep, 1e-12);
  EXPECT_EQ(taken.report.tolerance_missed, 3);
}

}  // namespace
}  // namespace ragdoll
