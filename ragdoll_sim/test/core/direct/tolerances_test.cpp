#include "core/direct/tolerances.h"

#include <gtest/gtest.h>

namespace ragdoll {
namespace {

/// As the error of a method of second order, but for coarse steps and where rounding is near.
TEST(Tolerances, FollowTheSquareOfTheStep) {
  const Tolerances usual = tolerancesFor(1.0 / 240), half = tolerancesFor(1.0 / 480);
  EXPECT_NEAR(half.contact, usual.contact / 4, 1e-20);
  EXPECT_NEAR(half.touching, usual.touching / 4, 1e-20);
  EXPECT_NEAR(half.touching_angle, usual.touching_angle / 4, 1e-20);
  EXPECT_EQ(tolerancesFor(1.0 / 60).contact, tolerancesFor(1.0 / 30).contact);
  EXPECT_EQ(tolerancesFor(1e-7).contact, tolerancesFor(1e-8).contact);
  EXPECT_GT(tolerancesFor(1e-8).contact, 0);
}

/// What parts may err by bounds them, but for coarse steps and where rounding is near.
TEST(Tolerances, ShrinkWithWhatAPartMayErrBy) {
  EXPECT_NEAR(tolerancesWithin(1e-3).contact, 1e-8, 1e-20);
  EXPECT_NEAR(tolerancesWithin(1e-3).touching, 1e-7, 1e-20);
  EXPECT_EQ(tolerancesWithin(1).contact, tolerancesFor(1).contact);
  EXPECT_EQ(tolerancesWithin(1e-9).touching, tolerancesFor(0).touching);
}

}  // namespace
}  // namespace ragdoll
