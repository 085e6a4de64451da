#include "core/direct/position_solver.h"

#include <gtest/gtest.h>

#include "core/direct/candidates.h"
#include "core/direct/motion.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// A rod that falls flat on the floor: it stops at it, pressed by m g less what its way to the
/// floor takes.
struct Landing : DirectIsland {
  static constexpr double kGap = 1e-4, kSpeed = 0.1, kRadius = 0.05;

  Landing() : DirectIsland(scene()) {
    whole = freeMotion(body(), h);
    findCandidates(island, h);
  }
  static Scene scene() {
    Scene scene = sceneOf(oneStick(1, 3, kRadius), Vec3(0, 0, kRadius + kGap));
    scene.ragdolls[0].velocity = Vec3(0, 0, -kSpeed);
    scene.obstacles = {floorPlane()};
    return scene;
  }
  bool whole = false;
};

TEST(PositionSolver, EndsAtTheFloor) {
  Landing one;
  ASSERT_TRUE(one.whole);
  int contacts = 0;
  ASSERT_TRUE(solvePositions(one.island, one.h, contacts));
  EXPECT_EQ(contacts, 2);
  const double way = -Landing::kSpeed * one.h - 0.5 * 9.81 * one.h * one.h;
  const double masses[] = {1, 3};
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(one.body().motion.dx(2, i), -Landing::kGap, 1e-9);
    EXPECT_NEAR(one.body().total[i], masses[i] * (-Landing::kGap - way), 1e-9);
  }
}

TEST(PositionSolver, ImplicitlyToo) {
  Landing one;
  ASSERT_TRUE(solvePositionsImplicitly(one.island, one.h));
  EXPECT_NEAR(one.body().motion.dx(2, 0), -Landing::kGap, 1e-9);
}

TEST(PositionSolver, LeavesAFreeMotion) {
  DirectIsland one(sceneOf(oneStick(), Vec3(0, 0, 1)));
  ASSERT_TRUE(freeMotion(one.body(), one.h));
  findCandidates(one.island, one.h);
  const Points free = one.body().motion.dx;
  int contacts = 0;
  ASSERT_TRUE(solvePositions(one.island, one.h, contacts));
  EXPECT_EQ(contacts, 0);
  EXPECT_EQ(one.body().motion.dx, free);
}

}  // namespace
}  // namespace ragdoll
