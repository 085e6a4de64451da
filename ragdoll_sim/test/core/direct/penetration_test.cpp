// What a motion leaves of the overlap of two capsules (penetration.h).
#include <gtest/gtest.h>

#include <cmath>

#include "core/direct/penetration.h"

namespace ragdoll {
namespace {

constexpr double kStep = 1.0 / 120;

Contact pair(double gap, double before) {
  Contact contact;
  contact.count = 4;
  contact.gap_start = gap;
  contact.before = before;
  return contact;
}

/// Ends that the contact's plane has behind it, though capsules do not overlap, are out of it at
/// the end of a whole step; a part of one brings them as far as it is of the step.
TEST(PairOverlap, EndsBehindThePlaneComeOutEvenly) {
  const Contact apart = pair(2e-5, -6e-4);
  EXPECT_DOUBLE_EQ(allowedPenetration(apart, kStep, kStep), 0);
  EXPECT_DOUBLE_EQ(allowedPenetration(apart, 0.25 * kStep, kStep), 0.75 * 6e-4);
  EXPECT_DOUBLE_EQ(allowedPenetration(pair(2e-5, 1e-5), 0.25 * kStep, kStep), 0);
}

/// 0.5 mm stay, what is more shrinks with 50 ms.
TEST(PairOverlap, OverlapShrinks) {
  EXPECT_DOUBLE_EQ(allowedPenetration(pair(-3e-4, -3e-4), kStep, kStep), 3e-4);
  EXPECT_NEAR(allowedPenetration(pair(-25e-4, -25e-4), kStep, kStep),
              5e-4 + 20e-4 * std::exp(-kStep / 0.05), 1e-18);
}

}  // namespace
}  // namespace ragdoll
