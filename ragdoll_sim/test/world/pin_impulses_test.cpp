// What several pins of one body are told to give, against statics and a pendulum.
#include "ragdoll_sim/world/contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/world/world.h"
#include "support/gravity.h"

namespace ragdoll {
namespace {

using test::kG;

/// [N] by the body on each pin, mean over so many steps.
std::vector<Vec3> forces(World& world, int steps) {
  world.keepContacts(true);
  for (int i = 0; i < steps; ++i) world.advance();
  const ContactReport report = *world.takeContacts();
  world.keepContacts(false);
  std::vector<Vec3> all;
  for (const Vec3& impulse : report.on_pins) all.push_back(impulse / report.interval);
  return all;
}

TEST(PinImpulses, ARodsEndsCarryTheirOwnWeight) {
  World world(parseScene(R"(
ragdolls:
  - position: [0, 0, 1]
    model: {particles: {a: {position: [0, 0, 0], mass: 1}, b: {position: [1, 0, 0], mass: 3}}, sticks: [[a, b]]}
pins: [b, a]
)"));
  const std::vector<Vec3> told = forces(world, 10);
  EXPECT_LT((told[0] + Vec3(0, 0, 3 * kG)).norm(), 1e-9) << told[0].transpose();
  EXPECT_LT((told[1] + Vec3(0, 0, kG)).norm(), 1e-9) << told[1].transpose();
}

/// A rod of 2 kg that ends beyond its pins, and a load at one end: by the lever.
TEST(PinImpulses, APlankOnTwoPinsIsALever) {
  World world(parseScene(R"(
ragdolls:
  - position: [0, 0, 1]
    model:
      particles: {a: {position: [0, 0, 0], mass: 1}, b: {position: [1, 0, 0], mass: 0.5}, c: {position: [1.5, 0, 0], mass: 2},
                  d: {position: [0.5, 0, -0.3], mass: 0.1}}
      sticks: [[a, b], [b, c], [a, c], [a, d], [b, d], [c, d]]
pins: [a, b]
)"));
  const std::vector<Vec3> told = forces(world, 10);
  const double moment = 0.5 * 1 + 2 * 1.5 + 0.1 * 0.5, weight = 3.6;  // about a
  EXPECT_NEAR(told[1].z(), -moment * kG, 1e-6);
  EXPECT_NEAR(told[0].z(), -(weight - moment) * kG, 1e-6);
}

/// A load on two strings 3 : 4 : 5.
const char* const kStrings = R"(
ragdolls:
  - position: [0, 0, 2]
    model:
      particles: {l: {position: [-0.3, 0, 0], mass: 0.1}, m: {position: [0, 0, -0.4], mass: 2}, r: {position: [0.3, 0, 0], mass: 0.1}}
      sticks: [[l, m], [m, r]]
pins: [l, r]
)";

TEST(PinImpulses, StringsPullAlongThemselves) {
  World world(parseScene(kStrings));
  const std::vector<Vec3> told = forces(world, 10);
  EXPECT_LT((told[0] - Vec3(0.75 * kG, 0, -1.1 * kG)).norm(), 1e-9) << told[0].transpose();
  EXPECT_LT((told[1] - Vec3(-0.75 * kG, 0, -1.1 * kG)).norm(), 1e-9) << told[1].transpose();
}

/// It swings across the line between the pins: at its lowest m g + m v^2 / l along the strings.
TEST(PinImpulses, StringsHoldAPendulum) {
  const auto error = [](double hz) {
    Scene scene = parseScene(kStrings);
    scene.solver.step = 1 / hz;
    const double speed = 1.5;
    scene.ragdolls[0].velocity = Vec3(0, speed, 0);
    World world(scene);
    const std::vector<Vec3> told = forces(world, 1);
    const double angle = speed / 0.4 * 0.5 / hz;  // in the middle of the step
    const double v2 = speed * speed - 2 * kG * 0.4 * (1 - std::cos(angle));
    const double pull = 2 * (kG * std::cos(angle) + v2 / 0.4);
    const Vec3 along(0, std::sin(angle), -std::cos(angle));
    const Vec3 wanted = 0.5 * pull * along + Vec3(0.375 * pull, 0, -0.1 * kG);
    return (told[0] - wanted).norm();
  };
  EXPECT_LT(error(120), 0.1);
  EXPECT_LT(error(1200), 1e-3);
}

/// By both hands, with limits that press: what they are told carries weight and torque.
TEST(PinImpulses, AHumanHangsByItsHands) {
  Scene scene = parseScene("ragdolls: [{model: human, position: [0, 0, 2]}]\nobstacles: []\n"
                           "pins: [left_hand, right_hand]\nsolver: {damping: 2, sleep: false}\n");
  World world(scene);
  for (int i = 0; i < 3600; ++i) world.advance();
  const std::vector<Vec3> told = forces(world, 1);
  const Model& model = *world.model();
  const Eigen::VectorXd mass = model.skeletonOf(model.ragdolls[0]).M.rowwise().sum();
  Vec3 weight = Vec3::Zero(), torque = Vec3::Zero();
  for (int i = 0; i < mass.size(); ++i) {
    const Vec3 own(0, 0, -mass[i] * kG);
    weight += own;
    torque += world.state().x.col(i).cross(own);
  }
  for (std::size_t p = 0; p < told.size(); ++p) {
    weight -= told[p];
    torque -= world.state().x.col(model.pins[p].particle).cross(told[p]);
  }
  EXPECT_LT(weight.norm(), 1e-6);
  EXPECT_LT(torque.norm(), 1e-3);
  EXPECT_LT((world.state().v).norm(), 1e-3) << "at rest";
  EXPECT_NEAR(told[0].z(), told[1].z(), 1);
  EXPECT_NEAR(told[0].y(), -told[1].y(), 1);
}

}  // namespace
}  // namespace ragdoll
