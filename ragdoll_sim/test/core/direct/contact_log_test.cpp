// What a step writes down of its contacts.
#include "ragdoll_sim/core/contact_log.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ragdoll_sim/core/step.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

/// A ball of 2 kg and 0.1 m that lies on the floor, or falls on it.
test::World ball(double height) {
  Scene scene = test::sceneOf(test::oneParticle(2, 0.1), Vec3(0, 0, height));
  scene.obstacles = {test::floorPlane()};
  scene.solver.method = Method::kShake;
  scene.solver.step = 1.0 / 120;
  return test::World(scene);
}

TEST(ContactLog, RestGivesTheWeightTimesTheStep) {
  test::World w = ball(0.1);
  ContactLog log;
  w.workspace.keepContacts(&log);
  for (int i = 0; i < 10; ++i) {
    w.steps(1);
    Vec3 sum = Vec3::Zero();
    for (const ContactImpulse& c : log.impulses) {
      sum += c.impulse;
      EXPECT_EQ(c.obstacle, 0);
      EXPECT_LT((c.point - Vec3(0, 0, 0)).norm(), 1e-9);
    }
    EXPECT_LT((sum - Vec3(0, 0, 2 * 9.81 / 120)).norm(), 1e-12);
  }
  w.workspace.keepContacts(nullptr);
  log.impulses.clear();
  w.steps(1);
  EXPECT_TRUE(log.impulses.empty()) << "nobody asks";
}

TEST(ContactLog, ImpactHasItsApproachAndMass) {
  test::World w = ball(0.6);
  ContactLog log;
  w.workspace.keepContacts(&log);
  double approach = 0, mass = 0;
  for (int i = 0; i < 60; ++i) {
    w.steps(1);
    for (const ContactImpulse& c : log.impulses) {
      approach = std::max(approach, c.approach);
      mass = std::max(mass, c.effective_mass);
    }
  }
  EXPECT_NEAR(approach, std::sqrt(2 * 9.81 * 0.5), 1e-6);
  EXPECT_NEAR(mass, 2, 1e-12);
}

TEST(ContactLog, AStateTellsWhatPressesOnIt) {
  test::World w = ball(0.1);
  w.steps(3);
  std::vector<ContactImpulse> pressing;
  appendPressing(w.model, w.state, {1}, pressing);
  ASSERT_EQ(pressing.size(), 1u);
  EXPECT_NEAR(pressing[0].impulse.z(), 2 * 9.81 / 120, 1e-12) << "all of it, not half";
  pressing.clear();
  appendPressing(w.model, w.state, {0}, pressing);
  EXPECT_TRUE(pressing.empty());
}

}  // namespace
}  // namespace ragdoll
