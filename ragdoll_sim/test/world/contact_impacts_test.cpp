// Impacts: what is told when they begin and when they are over.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "contact_scenes.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/world/contacts.h"
#include "ragdoll_sim/world/world.h"

namespace ragdoll {
namespace {

TEST(Contacts, RodHitAtItsEndAnswersWithAQuarterOfItsMass) {
  // 1 / (1/m + (L/2)^2 / (m L^2 / 12)) = m / 4.
  World world(parseScene(R"(
gravity: [0, 0, 0]
ragdolls:
  - position: [0, 0, 0.5]
    velocity: [0, 0, -2]
    model:
      particles: {a: {position: [0, 0, 0], radius: 0.05}, b: {position: [1, 0, 0], radius: 0.05}}
      sticks: [[a, b]]
      segments: {rod: {from: a, to: b, mass: 3, com: 0.5, gyration: 0.28867513459481287}}
obstacles: [{type: box, name: edge, position: [-0.5, 0, 0], size: [1.02, 1, 0.2], restitution: 0.5, friction: 0}]
)"));
  world.keepContacts(true);
  std::vector<ImpactReport> impacts;
  for (int i = 0; i < 60; ++i) {
    world.advance();
    const ContactReport report = *world.takeContacts();
    impacts.insert(impacts.end(), report.impacts.begin(), report.impacts.end());
  }
  ASSERT_GE(impacts.size(), 2u);
  EXPECT_FALSE(impacts[0].over);
  EXPECT_TRUE(impacts[1].over);
  EXPECT_EQ(impacts[0].id, impacts[1].id);
  const ContactImpulse& c = impacts[1].contact;
  EXPECT_NEAR(c.effective_mass, 3.0 / 4, 1e-6);
  EXPECT_NEAR(c.approach, 2, 1e-9);
  EXPECT_NEAR(c.impulse.z(), 1.5 * 2 * 3 / 4, 1e-6);
  EXPECT_EQ(regionName(*world.model(), 0, c.particle), "rod");
  EXPECT_EQ(otherName(*world.model(), c), "edge");
}

std::vector<ImpactReport> impactsOf(World& world, int steps) {
  world.keepContacts(true);
  std::vector<ImpactReport> impacts;
  for (int i = 0; i < steps; ++i) {
    world.advance();
    const ContactReport report = *world.takeContacts();
    impacts.insert(impacts.end(), report.impacts.begin(), report.impacts.end());
  }
  return impacts;
}

TEST(Contacts, BallThatFallsTellsItsApproach) {
  World world(parseScene(balls("1.1", 2, "obstacles: [{type: plane, restitution: 0.4}]\n")));
  const std::vector<ImpactReport> impacts = impactsOf(world, 120);
  ASSERT_GE(impacts.size(), 4u);
  const double v = std::sqrt(2 * kG * 1.0);
  EXPECT_NEAR(impacts[0].contact.approach, v, 1e-3);
  EXPECT_NEAR(impacts[0].contact.effective_mass, 2, 1e-9);
  EXPECT_NEAR(impacts[2].contact.approach, 0.4 * v, 0.02 * v);
}

TEST(Contacts, ImpactOfABallThatStaysDownIsOverATenthOfASecondLater) {
  World world(parseScene(balls("1.1", 2, "obstacles: [{type: plane, restitution: 0}]\n")));
  const std::vector<ImpactReport> impacts = impactsOf(world, 240);
  ASSERT_EQ(impacts.size(), 2u);
  const ImpactReport &begin = impacts[0], &end = impacts[1];
  EXPECT_TRUE(end.over);
  EXPECT_EQ(end.id, begin.id);
  const double h = world.stepLength(), lasted = end.time - begin.time;
  EXPECT_NEAR(lasted, Contacts::kSettled, 1.01 * h);
  EXPECT_NEAR(end.duration, lasted + h, 1e-9);
  const double v = std::sqrt(2 * kG * 1.0);
  EXPECT_NEAR(end.contact.impulse.z(), 2 * (v + kG * lasted), 2 * kG * h);
  EXPECT_NEAR(end.peak_force, 2 * v / h, 2 * kG);
}

/// Something is taken hold of meanwhile; its end was never told, and numbers began again at 1.
TEST(Contacts, ImpactGoesOnWhilePinsChange) {
  World world(parseScene(
      "ragdolls:\n  - {name: one, position: [0, 0, 1.1], model: {particles: {p: {position: [0, 0, "
      "0], "
      "radius: 0.1, mass: 2}}}}\n  - {name: two, position: [5, 0, 9], model: {particles: {p: "
      "{position: [0, 0, 0], radius: 0.1, mass: 2}}}}\nobstacles: [{type: plane, restitution: "
      "0}]\n"));
  world.keepContacts(true);
  std::vector<ImpactReport> impacts;
  for (int i = 0; i < 240 && impacts.size() < 2; ++i) {
    world.advance();
    const auto report = world.takeContacts();
    impacts.insert(impacts.end(), report->impacts.begin(), report->impacts.end());
    if (impacts.size() == 1 && world.model()->pins.empty()) world.attach("two/p", "gripper");
  }
  ASSERT_EQ(impacts.size(), 2U);
  EXPECT_FALSE(world.model()->pins.empty());
  EXPECT_FALSE(impacts[0].over);
  EXPECT_TRUE(impacts[1].over);
  EXPECT_EQ(impacts[1].id, impacts[0].id);
}

TEST(Contacts, SpringTellsItsDepthAndHowLongAnImpactLasts) {
  const double m = 2, k = 20000, h = 0.001;
  const std::string floor = "obstacles: [{type: plane, stiffness: 20000, damping: ";
  World resting(parseScene(balls("0.1", m, floor + "200}]\n")));
  resting.keepContacts(true);
  for (int i = 0; i < 240; ++i) resting.advance();
  EXPECT_NEAR(resting.takeContacts()->touches.at(0).contact.depth, m * kG / k, 1e-9);

  World world(parseScene(
      "gravity: [0, 0, 0]\nsolver: {step: 0.001}\n" +
      balls("0.15", m, floor + "0}]\npokes: [{body: p, force: [0, 0, -400], duration: 0.005}]\n")));
  const std::vector<ImpactReport> impacts = impactsOf(world, 200);
  ASSERT_EQ(impacts.size(), 2u);
  EXPECT_NEAR(impacts[1].contact.approach, 1, 1e-9);
  EXPECT_NEAR(impacts[1].duration, M_PI * std::sqrt(m / k), 1.5 * h);
  EXPECT_NEAR(impacts[1].contact.impulse.z(), 2 * m, 1e-6);
}

TEST(Contacts, ApproachByFastIsThatBeforeTheStep) {
  World world(parseScene(
      balls("1.1", 2, "obstacles: [{type: plane, restitution: 0}]\nsolver: {method: fast}\n")));
  const std::vector<ImpactReport> impacts = impactsOf(world, 120);
  ASSERT_GE(impacts.size(), 1u);
  EXPECT_NEAR(impacts[0].contact.approach, std::sqrt(2 * kG * 1.0), 1.5 * kG * world.stepLength());
}

TEST(Contacts, ImpactsHaveTheSameNumbersWhenOneBeginsToListenLater) {
  const std::string scene = balls("1.1 1.4", 2, "obstacles: [{type: plane, restitution: 0.6}]\n");
  World early(parseScene(scene)), late(parseScene(scene));
  for (int i = 0; i < 90; ++i) late.advance();
  std::vector<ImpactReport> all = impactsOf(early, 240), some = impactsOf(late, 150);
  ASSERT_GT(all.size(), some.size());
  ASSERT_GT(some.size(), 4u);
  all.erase(all.begin(), all.end() - static_cast<std::ptrdiff_t>(some.size()));
  for (std::size_t i = 0; i < some.size(); ++i) {
    EXPECT_EQ(some[i].id, all[i].id) << i;
    EXPECT_EQ(some[i].contact.impulse, all[i].contact.impulse) << i;
  }
}

}  // namespace
}  // namespace ragdoll
