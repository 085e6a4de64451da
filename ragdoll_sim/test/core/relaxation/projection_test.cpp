#include "core/relaxation/projection.h"

#include <gtest/gtest.h>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// A ball of 2 kg that would end `deep` below the floor, 0.1 m along it from where it was.
struct ProjectedLanding {
  World world{sceneOf(oneParticle(2))};
  Points x = world.state.x;
  ContactProjection projection;

  ProjectedLanding(double deep, double friction) {
    Contact floor;
    floor.particle = {0};
    floor.weight = {1};
    floor.count = 1;
    floor.obstacle = 0;
    floor.friction = friction;
    x.col(0) = Vec3(0.1, 0, -deep);
    projection.prepare(world.model, {floor}, world.state.x, x, world.state.v, 1.0 / 60);
    projection.sweep(x);
  }
};

TEST(Projection, PutsABallOnTheFloorAndSlowsItInsideTheCone) {
  const ProjectedLanding slides(0.05, 0.5);
  EXPECT_LT((slides.x.col(0) - Vec3(0.1 - 0.5 * 0.05, 0, 0)).norm(), 1e-15);
  const ProjectedLanding sticks(0.05, 3);
  EXPECT_LT(sticks.x.col(0).norm(), 1e-15);  // back to where it was
  EXPECT_EQ(sticks.projection.pressing(), 1);
}

TEST(Projection, LeavesABallAbove) {
  const ProjectedLanding above(-0.01, 0.5);
  EXPECT_EQ(Vec3(above.x.col(0)), Vec3(0.1, 0, 0.01));
  EXPECT_EQ(above.projection.pressing(), 0);
}

}  // namespace
}  // namespace ragdoll
