#include "core/direct/moving_obstacles.h"

#include <gtest/gtest.h>

#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// A ball, a floor, and a box that moves and turns in a step.
struct BoxPasses : DirectIsland {
  const Pose start{Vec3(3, 0, 1), Quat::Identity()};
  const Pose end{Vec3(3.4, -0.2, 0.1), Quat(Eigen::AngleAxisd(0.8, Vec3::UnitZ()))};

  BoxPasses() : DirectIsland(scene()) {
    world.inputs.obstacles = {world.state.obstacles[0], end};
    prepareDirect(context);
    beginStep(body(), report);
  }
  static Scene scene() {
    Scene scene = sceneOf(oneParticle(), Vec3(0, 0, 9));
    ObstacleSpec box;
    box.type = ObstacleSpec::Type::kBox;
    box.pose.position = Vec3(3, 0, 1);
    scene.obstacles = {floorPlane(), box};
    return scene;
  }
  /// The box from `from` on, for `part` [s].
  SweptObstacle boxOver(double from, double part) {
    body().time = from;
    return obstaclesOver(body(), part)[1];
  }
};

void expectAt(const Vec3& position, double turn, const Vec3& p, const Eigen::Matrix3d& R) {
  EXPECT_LT((p - position).norm(), 1e-14);
  EXPECT_LT((R - Eigen::AngleAxisd(turn, Vec3::UnitZ()).matrix()).norm(), 1e-14);
}

TEST(MovingObstacles, GoAndTurnEvenly) {
  BoxPasses one;
  ASSERT_TRUE(one.body().driven);
  const SweptObstacle middle = one.boxOver(0.25 * one.h, 0.5 * one.h);
  expectAt(Vec3(3.1, -0.05, 0.775), 0.2, middle.p0, middle.R0);
  expectAt(Vec3(3.3, -0.15, 0.325), 0.6, middle.p1, middle.R1);
  EXPECT_EQ(middle.index, 1);
  EXPECT_TRUE(middle.moves);
  EXPECT_NEAR(middle.bounds.lo.y(), -0.15 - 0.5 * (std::sin(0.6) + std::cos(0.6)), 1e-9);
}

/// To the last bit: what touches at the end of one part does so at the start of the next.
TEST(MovingObstacles, PartsFitTogetherAndEndWhereTheStepDoes) {
  BoxPasses one;
  const double part = one.h / 11;
  double from = 0;
  SweptObstacle box = one.boxOver(from, part);
  EXPECT_EQ(box.p0, one.start.position);
  for (int k = 1; k < 11; ++k) {
    from += part;
    const SweptObstacle next = one.boxOver(from, part);
    EXPECT_EQ(box.p1, next.p0) << k;
    EXPECT_EQ(box.R1, next.R0) << k;
    box = next;
  }
  EXPECT_EQ(box.p1, one.end.position);
  EXPECT_EQ(box.R1, one.end.orientation.toRotationMatrix());
  EXPECT_EQ(between(one.start, one.end, 1).orientation.coeffs(), one.end.orientation.coeffs());
}

TEST(MovingObstacles, AreTheStepsOwnOverAWholeStepOrWhereNoneMoves) {
  BoxPasses one;
  one.body().time = 0;
  EXPECT_EQ(&obstaclesOver(one.body(), one.h), &one.ws.obstacles);
  EXPECT_NE(&obstaclesOver(one.body(), 0.5 * one.h), &one.ws.obstacles);
  EXPECT_EQ(obstaclesOver(one.body(), 0.5 * one.h)[0].R1, one.ws.obstacles[0].R1);
  one.body().driven = false;
  EXPECT_EQ(&obstaclesOver(one.body(), 0.5 * one.h), &one.ws.obstacles);
}

/// A surface keeps its speed: in a quarter of the step it goes a quarter as far.
TEST(MovingObstacles, MotionOfAPartBecomesThatOfTheStep) {
  BoxPasses one;
  Contact on_box, on_body;
  on_box.obstacle = 1;
  on_box.surface_motion = on_body.surface_motion = Vec3(0.1, -0.05, 0);
  for (Contact* c : {&on_box, &on_body}) scaleMotion(*one.body().context, 0.25 * one.h, *c);
  EXPECT_LT((on_box.surface_motion - Vec3(0.4, -0.2, 0)).norm(), 1e-15);
  EXPECT_EQ(on_body.surface_motion, Vec3(0.1, -0.05, 0));
  scaleMotion(*one.body().context, one.h, on_body);
  EXPECT_EQ(on_body.surface_motion, Vec3(0.1, -0.05, 0));
}

}  // namespace
}  // namespace ragdoll
