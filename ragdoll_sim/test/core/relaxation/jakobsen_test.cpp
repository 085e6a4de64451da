#include <gtest/gtest.h>

#include "ragdoll_sim/core/step.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

Scene relaxed(SkeletonSpec skeleton) {
  Scene scene = sceneOf(std::move(skeleton), Vec3(0, 0, 1));
  scene.solver.method = Method::kJakobsen;
  return scene;
}

/// Position Verlet [Jakobsen2001, sec. 2]: n steps fall by g h^2 n (n + 1) / 2, v = g h n.
TEST(Jakobsen, FallsByVerlet) {
  World world(relaxed(oneParticle()));
  const double h = world.model.solver.step;
  world.steps(10);
  const double by_verlet = 9.81 * h * h * 55, by_parabola = 9.81 * h * h * 50;
  const double fallen = 1 - world.x(0).z();
  EXPECT_GT(fallen, by_parabola - 1e-12);
  EXPECT_LT(fallen, by_verlet + 1e-12);
}

/// A stick whose mass is at its ends is drawn back to its length about its centre of mass.
TEST(Jakobsen, KeepsTheSticks) {
  Scene scene = relaxed(oneStick(1, 3));
  scene.gravity.setZero();
  scene.ragdolls[0].angular_velocity = Vec3(0, 0, 4);
  World world(scene);
  world.steps(120);
  EXPECT_NEAR((world.x(1) - world.x(0)).norm(), 1, 1e-3);
  EXPECT_LT((0.25 * world.x(0) + 0.75 * world.x(1) - Vec3(0.75, 0, 1)).norm(), 1e-9);
}

}  // namespace
}  // namespace ragdoll
