#include "core/contact/compliance.h"

#include <gtest/gtest.h>

namespace ragdoll {
namespace {

/// The same force goes through both: their ways add up, and of dampers their speeds.
TEST(Compliance, OfTwoInSeriesAddsUp) {
  const Compliance skin{2e-4, 30}, mat{5e-4, 60};
  const double force = 7, speed = force / 30 + force / 60;
  for (const Compliance& both : {inSeries(skin, mat), inSeries(mat, skin)}) {
    EXPECT_NEAR(force * both.compliance, force * 2e-4 + force * 5e-4, 1e-18);
    EXPECT_NEAR(both.damping * speed, force, 1e-13);
  }
  EXPECT_EQ(inSeries(skin, {5e-4, 0}).damping, 0);  // what does not damp lets all through
  EXPECT_EQ(inSeries({5e-4, 0}, {2e-4, 0}).damping, 0);
}

TEST(Compliance, WhatIsRigidCountsForNothing) {
  const Compliance mat{5e-4, 60}, rigid;
  for (const Compliance& both : {inSeries(rigid, mat), inSeries(mat, rigid)}) {
    EXPECT_EQ(both.compliance, mat.compliance);
    EXPECT_EQ(both.damping, mat.damping);
  }
  EXPECT_EQ(inSeries(rigid, rigid).compliance, 0);
}

/// A body's regions give way where the scene says so of it, obstacles where anything does.
TEST(Compliance, IsWhatTheSceneSwitchesOn) {
  const std::vector<Compliance> regions{{}, {2e-4, 30}};
  Model model;
  Obstacle floor;
  floor.contact = {5e-4, 60};
  Ragdoll body;
  const auto of = [&] { return giveOf(model, floor, body, regions, 1).compliance; };
  EXPECT_EQ(of(), 0);
  model.compliant = true;
  EXPECT_EQ(of(), 5e-4);
  EXPECT_EQ(giveOf(body, regions, 1).compliance, 0);
  body.compliant = true;
  EXPECT_DOUBLE_EQ(of(), 7e-4);
  EXPECT_EQ(giveOf(body, regions, 1).compliance, 2e-4);
}

TEST(Compliance, TouchesAtRestOrDeepInASpring) {
  const Compliance rigid, soft{5e-4, 0};
  EXPECT_TRUE(touchesAtStart(rigid, 0) && touchesAtStart(soft, 0));
  EXPECT_FALSE(touchesAtStart(rigid, 1e-3) || touchesAtStart(soft, 1e-3));
  EXPECT_TRUE(touchesAtStart(soft, -0.05));
  EXPECT_FALSE(touchesAtStart(rigid, -0.05));
}

}  // namespace
}  // namespace ragdoll
