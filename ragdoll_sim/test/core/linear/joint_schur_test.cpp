#include "core/linear/joint_schur.h"

#include <gtest/gtest.h>

#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// Balls of 1 kg and 3 kg that meet at 2 m/s: the impulse is 2 m/s over 1/1 + 1/3 per kg.
TEST(JointSchur, TwoBallsStopEachOther) {
  Scene scene = sceneOf(oneParticle(1));
  scene.ragdolls.push_back(sceneOf(oneParticle(3)).ragdolls[0]);
  scene.ragdolls[1].name = "other";
  const World world(scene);
  Contact contact;
  contact.particle = {0, 0, 1, 1};
  contact.weight = {1, 0, -1, 0};
  contact.count = 4;
  contact.other = 1;
  Schur schur[2];
  JointSchur joint;
  for (int i = 0; i < 2; ++i) {
    schur[i].start(i);
    EXPECT_EQ(joint.addBody(schur[i]), i);
    schur[i].addContact(contact, 0, 2 * i, 2 * i + 2);
  }
  joint.addShared(contact, 0, 0, 1, 0);
  for (int i = 0; i < 2; ++i) {
    const StickRows& rows = *world.model.systemOf(world.model.ragdolls[i]).direct.rows;
    StickSolver none;
    none.resize(rows);
    none.setPose(rows, world.state.x.data() + 3 * i);
    schur[i].assemble(rows, none);
  }
  ASSERT_EQ(joint.size(), 1);
  RowValues b, p;
  b.setZero(1);
  p.setZero(1);
  b[0] = -2;
  EXPECT_TRUE(joint.solve(b, p));
  EXPECT_NEAR(p[0], 1.5, 1e-12);
  std::vector<RowValues> parts;
  joint.split(p, parts);
  Vec3 v[2] = {Vec3(0, 0, -1), Vec3(0, 0, 1)};
  for (int i = 0; i < 2; ++i) schur[i].move(parts[i], v[i].data());
  EXPECT_NEAR(v[0].z(), 0.5, 1e-12);  // both as their centre of mass
  EXPECT_NEAR(v[1].z(), 0.5, 1e-12);
  joint.addAnswer(1, parts, b);
  EXPECT_NEAR(b[0], 0, 1e-12);  // nothing closes any more
}

}  // namespace
}  // namespace ragdoll
