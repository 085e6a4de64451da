#include "core/fast/dispatch.h"

#include <gtest/gtest.h>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(Dispatch, IsNoWiderThanAllowed) {
  for (const bool single_precision : {false, true}) {
    EXPECT_EQ(fast::packFor(single_precision, 1000, 1).lanes, 1);
    EXPECT_LE(fast::packFor(single_precision, 1000, 4).lanes, 4);
    EXPECT_EQ(fast::packFor(single_precision, 1, 0).lanes, 1);
    EXPECT_LE(fast::packFor(single_precision, 2, 0).lanes, 4);
    EXPECT_GE(fast::packFor(single_precision, 1000, 0).lanes, 2);
  }
}

}  // namespace
}  // namespace ragdoll
