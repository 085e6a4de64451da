// `method: rk` from event to event where bodies that give way touch each other: springs and dampers
// in series press from where they are met until they would pull. docs/equations.md#event-driven-rk.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/ends.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

Scene parseRkScene(const std::string& text, double hz = 120) {
  Scene scene = parseScene("ragdoll_collision: true\ngravity: [0, 0, 0]\n" + text +
                           "solver: {method: rk, events: true, sleep: false}\n");
  scene.solver.step = 1 / hz;
  return scene;
}

/// A bar of 0.4 m along x, thinner at its second end.
std::string taperedBar(const std::string& where, const std::string& contact, double mass = 1,
                       double thinner = 0.05) {
  return "  - {contact: compliant, " + where +
         ", model: {particles: {a: {position: [0, 0, 0], radius: 0.05}, "
         "b: {position: [0.4, 0, 0], radius: " +
         std::to_string(thinner) +
         "}}, sticks: [[a, b]], segments: {bar: {from: a, to: b, mass: " + std::to_string(mass) +
         ", gyration: 0.289, contact: " + contact + "}}}}\n";
}

/// Gap and its rate of two masses on a spring and damper between them, from when they meet.
struct SpringMeeting {
  double stiffness, damping, answer = 0, speed = 0;

  double decay() const { return 0.5 * damping * answer; }
  double pulse() const { return std::sqrt(stiffness * answer - decay() * decay()); }
  double gap(double t) const {
    return -speed / pulse() * std::exp(-decay() * t) * std::sin(pulse() * t);
  }
  double rate(double t) const {
    return -speed * std::exp(-decay() * t) *
           (std::cos(pulse() * t) - decay() / pulse() * std::sin(pulse() * t));
  }
  /// [s] Until spring and damper would pull: k sin(w t) = d (decay sin(w t) - w cos(w t)).
  double lasts() const {
    return std::atan2(damping * pulse(), damping * decay() - stiffness) / pulse();
  }
};

/// Of two bars of 2 and 3 kg that meet at 1 and -0.5 m/s along an axis, 0.05 m apart at first.
void expectMeeting(const Scene& scene, int axis, int of_one, int of_other, SpringMeeting meeting) {
  const double m0 = 2, m1 = 3, v0 = 1, v1 = -0.5, apart = 0.05;
  World world(scene);
  meeting.answer = 1 / m0 + 1 / m1;
  meeting.speed = v0 - v1;
  const double meet = apart / (v0 - v1), part = meeting.lasts();
  const double centre = (m0 * v0 + m1 * v1) / (m0 + m1);
  for (int n = 1; n <= 30; ++n) {
    EXPECT_EQ(world.steps(1).handed_over, 0) << n;
    const double t = n / 120.0, in = std::min(std::max(0.0, t - meet), part);
    const double rate = meeting.rate(in);
    const double gap = apart + meeting.gap(in) +
                       (std::min(t, meet) * (v1 - v0) + std::max(0.0, t - meet - part) * rate);
    ASSERT_NEAR((world.x(of_other) - world.x(of_one))[axis] - 0.1, gap, 1e-9) << n;
    ASSERT_NEAR(world.v(of_one)[axis], centre - m1 / (m0 + m1) * rate, 1e-9) << n;
    ASSERT_NEAR(world.v(of_other)[axis], centre + m0 / (m0 + m1) * rate, 1e-9) << n;
  }
  EXPECT_GT((world.v(of_other) - world.v(of_one))[axis], 0) << "they part";
}

/// In one line, so that they are as balls: half a sine long; with dampers until they would pull.
TEST(EventsOnSoftBodies, EndsMeetAndPartByTheFormula) {
  const auto meet = [](const std::string& one, const std::string& other, double k, double d) {
    expectMeeting(
        parseRkScene(
            "ragdolls:\n" +
            taperedBar("name: one, position: [-0.4, 0, 0], velocity: [1, 0, 0]", one, 2) +
            taperedBar("name: two, position: [0.15, 0, 0], velocity: [-0.5, 0, 0]", other, 3)),
        0, 1, 2, {k, d});
  };
  meet("{stiffness: 3000}", "{stiffness: 1500}", 1000, 0);
  meet("{stiffness: 3000, damping: 20}", "{stiffness: 1500, damping: 60}", 1000, 15);
}

/// Two springs, one at each end.
TEST(EventsOnSoftBodies, BarsThatMeetFlatPartByTheFormulaOfTwoSprings) {
  expectMeeting(parseRkScene("ragdolls:\n" +
                             taperedBar("name: one, velocity: [0, 0, 1]",
                                        "{stiffness: 3000, damping: 20}", 2) +
                             taperedBar("name: two, position: [0, 0, 0.15], velocity: [0, 0, -0.5]",
                                        "{stiffness: 1500, damping: 60}", 3)),
                2, 0, 2, {2000, 30});
}

/// That shake comes to at its order: its error at 1000 and 4000 Hz [m].
void expectLimitOfShake(const Scene& scene, double time, double coarse, double fine) {
  int handed_over = 0;
  const Points exact = endInSteps(scene, 1.0 / 1000, time),
               steps = endInSteps(scene, 1.0 / 125, time, &handed_over);
  EXPECT_EQ(handed_over, 0);
  EXPECT_LT(largest(steps - exact), 1e-9)
      << "no order shows: pieces are as short as springs ask for";
  Scene shake = scene;
  shake.solver.method = Method::kShake;
  shake.solver.events = false;
  EXPECT_LT(largest(endInSteps(shake, 1.0 / 1000, time) - exact), coarse);
  EXPECT_LT(largest(endInSteps(shake, 1.0 / 4000, time) - exact), fine);
}

const std::string kSoft = "{stiffness: 20000}", kSoftAndDamped = "{stiffness: 8000, damping: 100}";

/// Off their middles, of unequal masses, radii, stiffness, damping, sliding on each other.
TEST(EventsOnSoftBodies, BarsThatMeetOffTheirMiddlesAreWhereShakeSaysInTheLimit) {
  expectLimitOfShake(
      parseRkScene("ragdolls:\n" +
                   taperedBar("name: one", "{stiffness: 20000, damping: 40}", 1, 0.03) +
                   taperedBar("name: two, position: [0.1, -0.13, 0.15], rpy_deg: [0, 0, 70], "
                              "velocity: [1.5, 0.4, -1], "
                              "angular_velocity: [1, -2, 0.5]",
                              kSoftAndDamped, 2, 0.06)),
      0.096, 6e-5, 1.5e-5);
  expectLimitOfShake(parseRkScene("ragdolls:\n" + taperedBar("name: one", kSoft) +
                                  taperedBar("name: two, position: [0.2, -0.18, 0.13], rpy_deg: "
                                             "[0, 0, 80], velocity: [1.5, 0.4, -1]",
                                             kSoft)),
                     0.2, 6e-5, 4e-6);
}

/// Across each other and off their middles, so that they turn while friction holds them, until the
/// springs let go. Slip on the axes in place of beside their turn as one, and what all but held for
/// the rest of a step: rk 9e-5 m off at 1000 Hz, and shake of first order.
TEST(EventsOnSoftBodies, BarsThatHoldOnToEachOtherAsTheyTurnLetGoWhereShakeSaysInTheLimit) {
  const std::string one = "ragdolls:\n" + taperedBar("name: one, velocity: [0, 0, 1]", kSoft);
  expectLimitOfShake(
      parseRkScene(
          one + taperedBar("name: two, position: [0.15, -0.2, 0.12], rpy_deg: [0, 0, 90]", kSoft)),
      0.104, 5e-5, 3e-6);
  expectLimitOfShake(
      parseRkScene(
          one + taperedBar("name: two, position: [0.15, -0.1, 0.12], rpy_deg: [0, 0, 70]", kSoft)),
      0.104, 3e-4, 2e-5);
  expectLimitOfShake(
      parseRkScene(
          "ragdolls:\n" + taperedBar("name: one, velocity: [0.8, 0, 1]", kSoft) +
          taperedBar("name: two, position: [0.2, -0.2, 0.12], rpy_deg: [0, 0, 90]", kSoft)),
      0.048, 5e-5, 3e-6);
}

/// By more than half of a radius. 1.4e-3 and 3.5e-4 m off where what is so deep pushes along the
/// normal of a step's start alone.
TEST(EventsOnSoftBodies, ABarThatSinksDeepIntoAnotherIsWhereShakeSaysInTheLimit) {
  const std::string softer = "{stiffness: 1000}";
  expectLimitOfShake(
      parseRkScene("ragdolls:\n" + taperedBar("name: one", softer) +
                   taperedBar("name: two, position: [0.15, 0.03, 0.12], rpy_deg: [0, -80, 0], "
                              "velocity: [0, 0, -3]",
                              softer)),
      0.08, 4e-5, 3e-6);
}

/// On a bar that is held; from its length on to its end, which is another mode.
TEST(EventsOnSoftBodies, ABallRunsOverTheEndOfABar) {
  Scene scene = parseRkScene("ragdolls:\n" + taperedBar("name: one", kSoftAndDamped, 3) +
                             "  - {name: two, position: [0.3, 0.01, 0.145], velocity: [1.2, 0, 0], "
                             "model: {particles: {p: {position: "
                             "[0, 0, 0], radius: 0.1, mass: 1}}}}\npins: [one/a, one/b]\n");
  scene.gravity = Vec3(0, 0, -9.81);
  expectLimitOfShake(scene, 0.4, 1e-4, 1e-5);
  EXPECT_GT(endInSteps(scene, 1.0 / 125, 0.4).col(2).x(), 0.4) << "it passes it";
}

/// On a bar that rests on a floor: it comes to rest m g/k deep, and the bar by the weight of both.
TEST(EventsOnSoftBodies, ABallRestsOnABarOnAFloor) {
  const double k = 20000, g = 9.81;
  Scene scene = parseRkScene(
      "ragdolls:\n" +
      taperedBar("name: bar, position: [0, 0, 0.05]", "{stiffness: 20000, damping: 200}", 3) +
      "  - {name: ball, position: [0.2, 0, 0.25], model: {particles: {p: {position: [0, 0, 0], "
      "radius: 0.1, mass: 2}}}}\nobstacles: [{type: plane, friction: 0.5}]\n");
  scene.gravity = Vec3(0, 0, -g);
  World world(scene);
  int handed_over = 0;
  for (int n = 0; n < 360; ++n) handed_over += world.steps(1).handed_over;
  EXPECT_EQ(handed_over, 0);
  EXPECT_NEAR(world.x(0).z() - 0.05, -5 * g / (2 * k), 1e-9);
  EXPECT_NEAR(world.x(2).z() - world.x(0).z() - 0.15, -2 * g / k, 1e-9);
  EXPECT_LT(largest(world.state.v), 1e-8);
}

}  // namespace
}  // namespace ragdoll::test
