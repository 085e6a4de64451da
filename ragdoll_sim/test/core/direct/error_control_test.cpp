#include "core/direct/error_control.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/constants.h"

namespace ragdoll {
namespace {

constexpr double kStep = 0.1;       ///< [s]
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
  ErrorControl control(kStep, kTolerance, taken.next);
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
      EXPECT_NEAR(taken.end, kStep, 1e-12);
      EXPECT_LE(taken.error, kTolerance * kStep);
      // The longest parts that aim at their part of the tolerance: no more work than asked for.
      const double longest = std::pow(kAim * kTolerance, 1.0 / order);
      EXPECT_LE(taken.parts, std::ceil(kStep / longest) + 8);
      EXPECT_NEAR(taken.next, longest, 0.1 * longest);
      EXPECT_EQ(taken.report.tolerance_missed, 0);
      EXPECT_EQ(taken.report.substeps, taken.parts);
      EXPECT_GT(taken.report.error_estimate, 0);
      EXPECT_LE(taken.report.error_estimate, kTolerance);
    }
}

TEST(ErrorControl, PassesAJumpAndTellsSo) {
  const auto jump = [](double from, double part) {
    return from <= 0.03 && from + part > 0.03 ? 1e-3 : 0.0;
  };
  const Taken taken = take(jump, 2);
  EXPECT_NEAR(taken.end, kStep, 1e-12);
  EXPECT_LT(taken.tries, 40);
  EXPECT_EQ(taken.report.tolerance_missed, 3);
  EXPECT_GT(taken.report.error_estimate, kTolerance);
}

TEST(ErrorControl, TakesAMotionThatIsNotFoundForAnError) {
  const auto none = [](double from, double part) {
    return from + part < 0.05 ? 0.0 : kUnknownRate;
  };
  const Taken taken = take(none, 4);
  EXPECT_NEAR(taken.end, kStep, 1e-12);
  EXPECT_EQ(taken.report.tolerance_missed, 3);
}

}  // namespace
}  // namespace ragdoll
