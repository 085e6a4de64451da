#include "core/direct/implicit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// A stick that turns by w h in a step of the true motion turns by atan(w h) in one of backward
/// Euler, since impulses act along where it ends: first order, and slower.
TEST(Implicit, TurnsAStickByTheArctangentAndKeepsMomentum) {
  DirectIsland one(weightless(oneStick()));
  Body& body = one.body();
  const Vec3 flight(0.3, -0.2, 0.5);
  for (const double turn : {0.1, 1.0, 10.0}) {  // w h
    const double speed = 0.5 * turn / one.h;    // of each end
    body.v().col(0) = flight - Vec3(0, speed, 0);
    body.v().col(1) = flight + Vec3(0, speed, 0);
    ASSERT_TRUE(solveImplicitMotion(body, one.h));
    EXPECT_LT((body.motion.dx.rowwise().mean() - one.h * flight).norm(), 1e-12);
    const Vec3 d =
        body.x().col(1) + body.motion.dx.col(1) - body.x().col(0) - body.motion.dx.col(0);
    EXPECT_NEAR(d.norm(), 1, 1e-9);
    EXPECT_NEAR(std::atan2(d.y(), d.x()), std::atan(turn), 1e-9);
  }
}

}  // namespace
}  // namespace ragdoll
