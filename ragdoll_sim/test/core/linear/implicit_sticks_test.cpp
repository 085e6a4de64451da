#include "core/linear/implicit_sticks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/linear/constants.h"
#include "core/linear/stick_solver.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// A stick of 1 m along x between two masses, whose ends would go by `free` (3 x 2) without it.
struct Moved {
  World world;
  ImplicitSticks s;
  bool found = false;

  explicit Moved(const Vec3& free, double mass_a = 1, double mass_b = 1, double lambda = 0)
      : world(sceneOf(oneStick(mass_a, mass_b))) {
    const DirectSystem& system = world.model.systems[0].direct;
    s.free.setZero(3, 2);
    s.free.col(1) = free;
    s.lambda.setConstant(1, lambda);
    found = moveImplicitly(system, system.rows->length2.data(), world.state.x, s);
  }
  Vec3 stick() const { return Vec3::UnitX() + s.dx.col(1) - s.dx.col(0); }
};

// Impulses act along the stick as it ends, so that it ends along the free motion's.
TEST(ImplicitSticks, PullAlongTheStickAsItEnds) {
  for (const Vec3& free : {Vec3(0, 0.6, 0), Vec3(0.5, -2, 1), Vec3(0, 0, 1000)}) {
    const Moved moved(free);
    ASSERT_TRUE(moved.found) << free.transpose();
    const Vec3 ends = Vec3::UnitX() + free;
    EXPECT_LT((moved.stick() - ends.normalized()).norm(), 1e-9) << free.transpose();
    // [kg] tension: 1 kg by half of what it is shortened by, per m of the stick.
    EXPECT_NEAR(moved.s.lambda[0], -0.5 * (ends.norm() - 1), 1e-9 * ends.norm());
    EXPECT_LT((moved.s.dx.rowwise().sum() - free).norm(), 1e-9 * ends.norm());
  }
}

TEST(ImplicitSticks, PushWhatWouldComeNear) {
  const Moved moved(Vec3(-0.5, 0, 0));
  ASSERT_TRUE(moved.found);
  EXPECT_NEAR(moved.s.lambda[0], 0.25, 1e-9);
  EXPECT_LT((moved.stick() - Vec3::UnitX()).norm(), 1e-9);
}

TEST(ImplicitSticks, ShareByTheMasses) {
  const Moved moved(Vec3(0.2, 0, 0), 1, 3);
  ASSERT_TRUE(moved.found);
  EXPECT_NEAR(moved.s.dx(0, 0), 0.15, 1e-9);  // 0.2 m by 3 kg of 4
  EXPECT_NEAR(moved.s.dx(0, 1), 0.15, 1e-9);
}

TEST(ImplicitSticks, ComeToTheSameFromAnotherStart) {
  const Moved moved(Vec3(0, 0.6, 0), 1, 1, -0.05);
  ASSERT_TRUE(moved.found);
  EXPECT_NEAR(moved.s.lambda[0], -0.5 * (std::sqrt(1.36) - 1), 1e-9);
}

TEST(ImplicitSticks, AreNoneOfWhatIsNotFinite) {
  EXPECT_FALSE(Moved(Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 0)).found);
  EXPECT_FALSE(Moved(Vec3(0, std::numeric_limits<double>::infinity(), 0)).found);
}

}  // namespace
}  // namespace ragdoll
