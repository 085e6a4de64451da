#include "core/direct/pair_rows.h"

#include <gtest/gtest.h>

#include "core/direct/candidates.h"
#include "core/direct/motion.h"
#include "core/direct/rows.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// Two rods that lie across each other 0.4 mm apart and do not move.
struct Crossed : DirectIsland {
  Crossed() : DirectIsland(scene()) {
    for (Body* body : island.bodies) body->motion.dx.setZero(3, 2);
    findCandidates(island, h);
    island.pairs.role.assign(island.pairs.contacts.size(), Role::kIfNear);
    buildRows(island, h, true);
    for (Body* body : island.bodies) body->total.setZero(body->constraints.own_rows);
    island.s.total.setZero(island.s.joint.size());
    evaluateGaps(island, h);
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

TEST(PairRows, AreBesideTheBodiesOwn) {
  Crossed one;
  ASSERT_EQ(one.island.pairs.contacts.size(), 1U);
  const int row = one.island.pairs.row[0];
  ASSERT_GE(row, 0);
  EXPECT_NEAR(one.island.s.b[row], 4e-4, 1e-12);
  EXPECT_FALSE(anyCloses(one.island));
  EXPECT_EQ(worstPairResidual(one.island, true), 0);
  one.island.s.total[row] = 1e-3;  // what presses is closed
  EXPECT_NEAR(worstPairResidual(one.island, true), 4e-4, 1e-12);
}

TEST(PairRows, SeeBothBodiesMotions) {
  Crossed one;
  one.island.bodies[0]->motion.dx.row(2).setConstant(3e-4);
  one.island.bodies[1]->motion.dx.row(2).setConstant(-2e-4);
  one.island.bodies[1]->motion.dx.row(0).setConstant(1e-3);
  evaluateGaps(one.island, one.h);
  const int row = one.island.pairs.row[0];
  EXPECT_NEAR(one.island.s.b[row], -1e-4, 1e-12);
  EXPECT_TRUE(anyCloses(one.island));
  EXPECT_NEAR(worstPairResidual(one.island, true), 1e-4, 1e-12);
  EXPECT_NEAR(one.island.s.b.segment(row + 1, 2).norm(), 1e-3, 1e-12);
}

TEST(PairRows, StartAtWhatPressedLast) {
  Crossed one;
  one.island.s.total[one.island.pairs.row[0]] = 5e-4;
  rememberPairs(one.island, one.h);
  ASSERT_EQ(one.island.pairs.pressing.size(), 1U);
  warmStart(one.island, 0.5 * one.h);
  EXPECT_NEAR(one.island.s.p[one.island.pairs.row[0]], 5e-4 / 4, 1e-15);
}

}  // namespace
}  // namespace ragdoll
