#include "core/direct/rows.h"

#include <gtest/gtest.h>

#include "core/direct/candidates.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// A ball over a floor, at rest, with its candidates and rows.
struct BallOverFloor : DirectIsland {
  explicit BallOverFloor(double gap, double friction = 0.5) : DirectIsland(scene(gap, friction)) {
    body().motion.dx.setZero(3, 1);
    findCandidates(body(), h);
    buildRows(body(), h, true);
    body().total.setZero(body().constraints.own_rows);
    evaluateGaps(body(), h);
  }
  static Scene scene(double gap, double friction) {
    Scene scene = sceneOf(oneParticle(1, 0.1), Vec3(0, 0, 0.1 + gap));
    scene.obstacles = {floorPlane(friction)};
    return scene;
  }
};

TEST(Rows, AreOfWhatIsNear) {
  EXPECT_EQ(BallOverFloor(5e-3).body().constraints.own_rows, 0);
  EXPECT_EQ(BallOverFloor(5e-4).body().constraints.own_rows, 3);
  EXPECT_EQ(BallOverFloor(5e-4, 0).body().constraints.own_rows, 1);
}

TEST(Rows, HaveTheGapAndTheSlip) {
  BallOverFloor above(5e-4), below(-1e-4);
  EXPECT_NEAR(above.body().b[0], 5e-4, 1e-15);
  EXPECT_NEAR(below.body().b[0], -1e-4, 1e-15);
  EXPECT_NEAR(worstResidual(below.body(), true), 1e-4, 1e-15);
  below.body().motion.dx.col(0) = Vec3(3e-3, 4e-3, 0);
  evaluateGaps(below.body(), below.h);
  EXPECT_NEAR(below.body().b.tail(2).norm(), 5e-3, 1e-15);
}

TEST(Rows, AreNotSolvedWhileWhatPressesIsOpen) {
  BallOverFloor above(5e-4);
  EXPECT_EQ(worstResidual(above.body(), true), 0);
  above.body().total[0] = 1e-3;
  EXPECT_NEAR(worstResidual(above.body(), true), 5e-4, 1e-15);
  EXPECT_EQ(worstResidual(above.body(), false), 0);
}

TEST(Rows, StartAtTheImpulsesOfTheLastMotion) {
  BallOverFloor ball(-1e-4);
  Body& body = ball.body();
  body.total[0] = 4e-4;
  body.total[1] = 1e-4;
  body.total[2] = -2e-4;
  rememberImpulses(body, ball.h);
  Eigen::VectorXd p(3);
  warmStart(body, ball.h, p);
  EXPECT_LT((p - body.total).norm(), 1e-18);
  warmStart(body, 0.5 * ball.h, p);  // forces stay: impulses times h shrink by four
  EXPECT_LT((4 * p - body.total).norm(), 1e-18);
}

}  // namespace
}  // namespace ragdoll
