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
    buildRows(body(), true);
    body().total.setZero(body().constraints.own_rows);
  }
  Eigen::VectorXd gaps() {
    Eigen::VectorXd b(body().constraints.own_rows);
    evaluateGaps(body(), h, Vec3::Zero(), b);
    return b;
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
  EXPECT_NEAR(above.gaps()[0], 5e-4, 1e-15);
  EXPECT_NEAR(below.gaps()[0], -1e-4, 1e-15);
  EXPECT_NEAR(worstResidual(below.body(), true), 1e-4, 1e-15);
  below.body().motion.dx.col(0) = Vec3(3e-3, 4e-3, 0);
  EXPECT_NEAR(below.gaps().tail(2).norm(), 5e-3, 1e-15);
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

/// Two rods that lie across each other 0.4 mm apart and do not move.
struct Crossed : DirectIsland {
  Crossed() : DirectIsland(scene()) {
    for (Body* body : island.bodies) body->motion.dx.setZero(3, 2);
    findCandidates(island, h);
    island.pairs.role.assign(island.pairs.contacts.size(), Role::kIfNear);
    buildRows(island, true);
    for (Body* body : island.bodies) body->total.setZero(body->constraints.own_rows);
    island.s.total.setZero(island.s.joint.size());
    evaluateGaps(island, h, island.s.b);
  }
  static Scene scene() {
    Scene scene = weightless(oneStick(1, 1, 0.05));
    scene.ragdolls[0].pose.position = Vec3(-0.5, 0, 0);
    RagdollSpec other = scene.ragdolls[0];
    other.name = "other";
    other.pose.position = Vec3(0, -0.5, 0.1004);
    other.pose.orientation = Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitZ());
    scene.ragdolls.push_back(other);
    scene.ragdoll_collision = true;
    return scene;
  }
};

TEST(Rows, OfPairsAreBesideTheBodiesOwn) {
  Crossed one;
  ASSERT_EQ(one.island.pairs.contacts.size(), 1U);
  const int row = one.island.pairs.row[0];
  ASSERT_GE(row, 0);
  EXPECT_NEAR(one.island.s.b[row], 4e-4, 1e-12);
  EXPECT_FALSE(anyCloses(one.island, one.island.s.b));
  EXPECT_EQ(worstResidual(one.island, true), 0);
  one.island.s.total[row] = 1e-3;  // what presses is closed
  EXPECT_NEAR(worstResidual(one.island, true), 4e-4, 1e-12);
}

TEST(Rows, SeeBothBodiesMotions) {
  Crossed one;
  one.island.bodies[0]->motion.dx.row(2).setConstant(3e-4);
  one.island.bodies[1]->motion.dx.row(2).setConstant(-2e-4);
  one.island.bodies[1]->motion.dx.row(0).setConstant(1e-3);
  evaluateGaps(one.island, one.h, one.island.s.b);
  const int row = one.island.pairs.row[0];
  EXPECT_NEAR(one.island.s.b[row], -1e-4, 1e-12);
  EXPECT_TRUE(anyCloses(one.island, one.island.s.b));
  EXPECT_NEAR(worstResidual(one.island, true), 1e-4, 1e-12);
  EXPECT_NEAR(one.island.s.b.segment(row + 1, 2).norm(), 1e-3, 1e-12);
}

TEST(Rows, OfPairsStartAtWhatPressedLast) {
  Crossed one;
  one.island.s.total[one.island.pairs.row[0]] = 5e-4;
  rememberImpulses(one.island, one.h);
  ASSERT_EQ(one.island.pairs.pressing.size(), 1U);
  warmStart(one.island, 0.5 * one.h, one.island.s.p);
  EXPECT_NEAR(one.island.s.p[one.island.pairs.row[0]], 5e-4 / 4, 1e-15);
}

}  // namespace
}  // namespace ragdoll
