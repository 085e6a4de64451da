#include "core/loading/system.h"

#include <gtest/gtest.h>

#include "core/loading/skeleton.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(System, PinsTakeNoPart) {
  const Skeleton s = buildSkeleton(oneStick(2, 4));
  std::vector<std::string> warnings;
  const System free = buildSystem(s, 0, {}, warnings), pinned = buildSystem(s, 0, {0}, warnings);
  EXPECT_NEAR(free.W(0, 0), 0.5, 1e-15);
  EXPECT_EQ(free.gravity, Eigen::RowVector2d(1, 1));
  EXPECT_EQ(pinned.W.row(0).norm(), 0);
  EXPECT_NEAR(pinned.W(1, 1), 0.25, 1e-15);
  EXPECT_EQ(pinned.gravity, Eigen::RowVector2d(0, 1));
  EXPECT_TRUE(warnings.empty());
}

}  // namespace
}  // namespace ragdoll
