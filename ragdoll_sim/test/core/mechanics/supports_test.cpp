#include "core/mechanics/supports.h"

#include <gtest/gtest.h>

namespace ragdoll {
namespace {

TEST(Cone, WhatSlidesIsAtItsBorderNotInside) {
  EXPECT_TRUE(isInsideCone(0.5, 10, 4.9));
  EXPECT_FALSE(isInsideCone(0.5, 10, 5));
  EXPECT_FALSE(isInsideCone(0.5, 10, 5 * (1 - 1e-9)));  // rounding of what slides
  EXPECT_TRUE(isInsideCone(0.5, 10, 5 * (1 - 1e-5)));
}

TEST(Cone, WhatDoesNotPressHoldsNothing) {
  EXPECT_FALSE(isInsideCone(0.5, 0, 0));
  EXPECT_FALSE(isInsideCone(0, 10, 0));
}

}  // namespace
}  // namespace ragdoll
