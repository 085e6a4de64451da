// A tolerance is kept whatever the step, and what is missed is told.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/tolerance_run.h"

namespace ragdoll {
namespace {

using namespace test;

/// A human without joints that swings from a hand.
Scene swingingByAHand() {
  Scene scene = parseScene(
      "ragdolls: [{model: human_lumped, position: [0, 0, 2]}]\npins: [ragdoll/right_hand]\n");
  removeJoints(scene);
  return scene;
}

TEST(Tolerance, OfRkIsMoreThanTheErrorOfASmoothMotionFromAnyStep) {
  const Points best = runOf(swingingByAHand(), Method::kRk, 1.0 / 16000, 0, 1).x;
  for (const double step : {1e-3, 1.0 / 120, 1.0 / 30, 0.1})
    for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8}) {
      const ToleranceRun run = runOf(swingingByAHand(), Method::kRk, step, tolerance, 1);
      EXPECT_LT(distance(run.x, best), tolerance) << step;
      EXPECT_EQ(run.report.tolerance_missed, 0);
      EXPECT_GT(run.report.error_estimate, 0);
      EXPECT_LE(run.report.error_estimate, tolerance);
    }
}

TEST(Tolerance, OfShakeIsATenthOfTheErrorOfASmoothMotionAtMostFromAnyStep) {
  const Points best = runOf(swingingByAHand(), Method::kRk, 1.0 / 16000, 0, 1).x;
  for (const double step : {1e-3, 1.0 / 120, 0.1})
    for (const double tolerance : {1e-2, 1e-3, 1e-4})
      EXPECT_LT(distance(runOf(swingingByAHand(), Method::kShake, step, tolerance, 1).x, best),
                10 * tolerance)
          << step;
}

/// Humans without joints that hang by a hand and spin at random.
std::vector<Scene> spinningByAHand(int count) {
  std::mt19937 random(5);
  const auto any = [&](double most) {
    Vec3 v;
    for (int i = 2; i >= 0; --i) v[i] = most * (2.0 * random() / random.max() - 1);
    return v;
  };
  std::vector<Scene> scenes;
  for (int k = 0; k < count; ++k) {
    scenes.push_back(parseScene(k % 2 ? "ragdolls: [{model: human, position: [0, 0, 2]}]\n"
                                        "pins: [ragdoll/left_hand]\n"
                                      : "ragdolls: [{model: human_lumped, position: [0, 0, 2]}]\n"
                                        "pins: [ragdoll/right_hand]\n"));
    scenes[k].ragdolls[0].velocity = any(1);
    scenes[k].ragdolls[0].angular_velocity = any(3);
    removeJoints(scenes[k]);
  }
  return scenes;
}

/// Limbs are whipped; each step begins where the one before ended, and so does a finer motion.
/// `shake` ended steps with parts of 30 ms, unknown, after some of half a millisecond that were
/// known (1400 times what is allowed); `rk` trusted its formula over a tenth of a second (1.6
/// times).
TEST(Tolerance, IsTheErrorOfALongStepAtMostWhereLimbsAreWhipped) {
  constexpr double kStep = 0.1;
  for (const Scene& hung : spinningByAHand(24))
    for (const Method method : {Method::kShake, Method::kRk})
      for (const double tolerance : {1e-2, 1e-3}) {
        Scene scene = hung;
        scene.solver.method = Method::kRk;
        scene.solver.step = 1.0 / 4000;
        World fine(scene);
        scene.solver.method = method;
        scene.solver.step = kStep;
        scene.solver.tolerance = tolerance;
        World world(scene);
        for (int i = 0; i < 10; ++i) {
          fine.state = world.state;
          fine.state.multipliers.clear();
          fine.state.step = 400 * i;  // at 4000 Hz
          fine.steps(400);
          world.steps(1);
          EXPECT_LT(distance(world.state.x, fine.state.x),
                    (method == Method::kRk ? 0.3 : 1) * tolerance * kStep)
              << hung.ragdolls[0].velocity.transpose() << ": " << i;
        }
      }
}

/// Two balls, 1e-7 m apart, fly at a wall that throws back half of the speed. The first is thrown
/// onto the second and goes back to the wall with it, at (1 - e) / 2. Were the gap none, the first
/// would push the second along: both at e.
TEST(Tolerance, TellsANarrowGapFromNone) {
  constexpr double kRadius = 0.1, kGap = 1e-7, kAway = 2.53e-3, kBounce = 0.5;
  Scene scene = sceneOf(oneParticle(1, kRadius), Vec3(0, 0, kRadius + kAway));
  scene.gravity.setZero();
  scene.ragdoll_collision = true;
  scene.obstacles = {floorPlane(0, kBounce)};
  scene.ragdolls[0].velocity = Vec3(0, 0, -1);
  scene.ragdolls.push_back(scene.ragdolls[0]);
  scene.ragdolls[1].name = "second";
  scene.ragdolls[1].pose.position.z() += 2 * kRadius + kGap;
  const double seconds = 0.016, back = kBounce * (1 - kBounce) / 2;
  for (const double step : {1e-3, 0.004, 0.016})
    for (const double tolerance : {1e-2, 1e-5}) {
      const Points end = runOf(scene, Method::kShake, step, tolerance, seconds).x;
      EXPECT_NEAR(end(2, 0), kRadius + back * (seconds - kAway), 1e-6) << step << " " << tolerance;
      EXPECT_NEAR(end(2, 1) - end(2, 0), 2 * kRadius, 1e-6) << step << " " << tolerance;
    }
}

/// [1] How many times the tolerance a scene's error after `seconds` is, from steps of 1/60 s; the
/// reference goes through events.
double timesTheTolerance(const char* text, Method method, double tolerance, double seconds) {
  const Scene scene = parseScene(text);
  Scene exact = scene;
  exact.solver.events = true;
  const Points reference = runOf(exact, Method::kRk, 1.0 / 3840, 0, seconds).x;
  const Points end = runOf(scene, method, 1.0 / 60, tolerance, seconds).x;
  return distance(end, reference) / (tolerance * seconds);
}

/// A ball that is thrown at a sphere hits it elsewhere than along the chord of its way in the step:
/// 143 times the tolerance off at 1e-5 m/s if it does not, and not told.
TEST(Tolerance, IsKeptWhereTheWayToWhatIsHitIsCurved) {
  const char* const kBall = R"(
ragdolls:
  - {position: [0.06, 0, 0.3537], velocity: [1, 0, -1],
     model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.05}}}}
obstacles: [{type: sphere, position: [0, 0, 0], radius: 0.2, restitution: 0.5, friction: 0.3}]
)";
  for (const Method method : {Method::kShake, Method::kRk})
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6})
      EXPECT_LT(timesTheTolerance(kBall, method, tolerance, 0.15), 3) << tolerance;
}

/// A rod's tip turns past a floor, 0.1 mm too near to it, within a step of `rk`: 7000 times the
/// tolerance off at 1e-5 m/s if that is not seen.
TEST(Tolerance, OfRkIsKeptWhereATipGrazesAFloor) {
  const char* const kRod = R"(
gravity: [0, 0, 0]
ragdolls:
  - {position: [0, 0, 0.3299], rpy_deg: [0, 30.584, 0], angular_velocity: [0, 10, 0],
     model: {sticks: [[p, q]], particles: {p: {position: [-0.3, 0, 0], mass: 1, radius: 0.03},
       q: {position: [0.3, 0, 0], mass: 1, radius: 0.03}}}}
obstacles: [{type: plane, friction: 0.3, restitution: 0.5}]
)";
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5})
    EXPECT_LT(timesTheTolerance(kRod, Method::kRk, tolerance, 0.2), 3) << tolerance;
}

/// `rk` moves a rod freely to where one end lands, `shake` from there on: halves of the part had
/// that in common, and it was 7 times the tolerance off at 1e-5 m/s.
TEST(Tolerance, OfRkIsKeptAfterAnImpactWithinAPart) {
  const char* const kRod = R"(
ragdolls:
  - {position: [0, 0, 0.0823], rpy_deg: [0, -10, 0], velocity: [0.5, 0, -0.6],
     angular_velocity: [0, 6, 3],
     model: {sticks: [[p, q]], particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.05},
       q: {position: [0.4, 0, 0], mass: 2, radius: 0.05}}}}
obstacles: [{type: plane}]
solver: {damping: 8}
)";
  for (const double tolerance : {1e-4, 1e-5, 1e-6})
    EXPECT_LT(timesTheTolerance(kRod, Method::kRk, tolerance, 0.1), 3) << tolerance;
}

/// A ball that a spring throws back, within a step or some of them: its force is gone at both ends
/// of what it acts in.
TEST(Tolerance, IsKeptOnASpringThatComesAndGoes) {
  constexpr double kRadius = 0.05, kSeconds = 0.1, kSpeed = 2;
  for (const double stiffness : {3e3, 3e4, 3e5})
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5}) {
      int kept = 0, told = 0;
      for (int i = 0; i < 20; ++i) {
        const double gap = kSpeed * (0.005 + 0.003 * i), turn = std::sqrt(stiffness);  // 1 kg
        Scene scene = weightless(oneParticle(1, kRadius), Vec3(0, 0, -kSpeed));
        scene.ragdolls[0].pose.position.z() = kRadius + gap;
        scene.obstacles = {floorPlane(0)};
        scene.obstacles[0].contact.stiffness = stiffness;
        scene.obstacles[0].contact.damping = 0;
        const ToleranceRun run = runOf(scene, Method::kShake, 1.0 / 60, tolerance, kSeconds);
        const double pressed = kSeconds - gap / kSpeed, off = M_PI / turn;
        const double end =
            pressed > off ? kSpeed * (pressed - off) : -kSpeed / turn * std::sin(turn * pressed);
        const bool keeps = std::abs(run.x(2, 0) - kRadius - end) < 3 * tolerance * kSeconds;
        kept += keeps;
        told += !keeps && run.report.tolerance_missed > 0;
      }
      EXPECT_GE(kept + told, 19) << stiffness << " N/m, " << tolerance << ": " << told << " told";
    }
}

/// What the control may cost where nothing it does helps: two bodies on each other and on the
/// floor.
TEST(Tolerance, BoundsTheWork) {
  constexpr double kTolerance = 1e-3, kSeconds = 0.5;
  Scene scene = parseScene(
      "ragdolls: [{name: a, model: human, position: [0, 0, 0.3], rpy_deg: [0, -90, 0]},\n"
      "           {name: b, model: human, position: [0.1, 0.1, 0.7], rpy_deg: [0, 80, 30]}]\n"
      "obstacles: [{type: plane}]\nragdoll_collision: true\nsolver: {joint_damping: 2}\n");
  const ToleranceRun run = runOf(scene, Method::kShake, 1.0 / 60, kTolerance, kSeconds);
  EXPECT_GT(run.parts, 2 * 30);
  EXPECT_LT(run.parts, kSeconds / (5e-3 * std::sqrt(kTolerance)));
}

TEST(Tolerance, GivesTheSameBitsForAnyNumberOfThreads) {
  Scene scene = parseScene(
      "ragdolls: [{model: human, position: [0, 0, 1.2]}]\n"
      "obstacles: [{type: plane}]\n");
  for (int i = 1; i < 8; ++i) {
    scene.ragdolls.push_back(scene.ragdolls[0]);
    scene.ragdolls[i].name = "b" + std::to_string(i);
    scene.ragdolls[i].pose.position += Vec3(3 * i, 0, 0.03 * i);
  }
  scene.solver.threads = 1;
  const ToleranceRun one = runOf(scene, Method::kShake, 1.0 / 60, 1e-3, 0.6);
  scene.solver.threads = 3;
  const ToleranceRun three = runOf(scene, Method::kShake, 1.0 / 60, 1e-3, 0.6);
  EXPECT_EQ(distance(one.x, three.x), 0);
  EXPECT_EQ(one.parts, three.parts);
}

TEST(Tolerance, OfBodiesThatMeetIsControlledToo) {
  Scene scene = test::sceneOf(oneStick(1, 1, 0.1));
  scene.gravity.setZero();
  scene.ragdolls.push_back(scene.ragdolls[0]);
  scene.ragdolls[0].name = "a";
  scene.ragdolls[1].name = "b";
  scene.ragdolls[1].pose.position = Vec3(0.3, 0.1, 0.25);
  scene.ragdolls[1].velocity = Vec3(0, 0, -1);
  scene.ragdoll_collision = true;
  const ToleranceRun run = runOf(scene, Method::kShake, 1.0 / 60, 1e-2, 0.2);
  EXPECT_GT(run.report.error_estimate, 0);
  EXPECT_EQ(runOf(scene, Method::kShake, 1.0 / 60, 0, 0.2).report.error_estimate, 0);
}

}  // namespace
}  // namespace ragdoll
