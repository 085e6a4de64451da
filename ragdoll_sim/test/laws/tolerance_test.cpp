// A tolerance is kept whatever the step, and what is missed is told.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

struct Outcome {
  Points x;
  StepReport report;
  int parts = 0;
};

/// From the scene's start, or from a state that another run has come to.
Outcome runOf(Scene scene, Method method, double step, double tolerance, double seconds,
              const State* start = nullptr, bool events = false) {
  scene.solver.method = method;
  if (events) scene.solver.events = true;
  scene.solver.step = step;
  scene.solver.tolerance = tolerance;
  World world(scene);
  if (start) {
    world.state = *start;
    world.state.step = 0;
    world.state.time = 0;
  }
  Outcome run;
  for (int i = 0; i < static_cast<int>(std::lround(seconds / step)); ++i) {
    const StepReport report = world.steps(1);
    run.report += report;
    run.parts += report.substeps;
  }
  run.x = world.state.x;
  return run;
}

double distance(const Points& a, const Points& b) { return (a - b).colwise().norm().maxCoeff(); }

void removeJoints(Scene& scene) {
  SkeletonSpec skeleton = *scene.ragdolls[0].skeleton;
  skeleton.joints.clear();
  scene.ragdolls[0].skeleton = std::make_shared<const SkeletonSpec>(std::move(skeleton));
}

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
      const Outcome run = runOf(swingingByAHand(), Method::kRk, step, tolerance, 1);
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

enum class Kind { kSmooth, kLimits, kContact, kDamped };

/// A body that turns at random: without joints and with, by a hand; onto the ground, and damped.
Scene sceneOfKind(Kind kind, std::mt19937& random) {
  std::uniform_real_distribution<double> turn(-180, 180), speed(-3, 3);
  const bool falls = kind == Kind::kContact || kind == Kind::kDamped;
  Scene scene = parseScene(
      std::string("ragdolls: [{model: ") + (kind == Kind::kSmooth ? "human_lumped" : "human") +
      ", position: [0, 0, " + (falls ? "1.3" : "2") + "], rpy_deg: [" +
      std::to_string(turn(random) / 9) + ", " + std::to_string(turn(random) / 9) + ", " +
      std::to_string(turn(random)) + "], angular_velocity: [" + std::to_string(speed(random)) +
      ", " + std::to_string(speed(random)) + ", " + std::to_string(speed(random)) + "]}]\n" +
      (falls ? "obstacles: [{type: plane}]\n" : "pins: [ragdoll/right_hand]\n"));
  if (kind == Kind::kSmooth) removeJoints(scene);
  if (kind == Kind::kDamped) scene.solver.joint_damping = 2;
  scene.solver.method = Method::kShake;
  scene.solver.step = 1.0 / 240;
  return scene;
}

constexpr double kWindow = 0.1;  ///< [s]

struct Window {
  Scene scene;
  State start;
  Points exact;
  double uncertain = 0;  ///< [m] how far references of other steps are off
};

/// A state some fine steps on. What lies counts as touching though steps of 1/240 s leave it open
/// by up to 2.5e-6 m; to finer ones it would be free until it has fallen so far.
State settled(Scene scene, const State& start) {
  scene.solver.step = 1.0 / 16000;
  World world(scene);
  world.state = start;
  world.steps(16);
  return world.state;
}

std::vector<Window> windowsOf(Kind kind, int count) {
  std::vector<Window> windows;
  for (int seed = 0; seed < count; ++seed) {
    std::mt19937 random(seed + 1000 * static_cast<int>(kind));
    Window w{sceneOfKind(kind, random), {}, {}};
    World world(w.scene);
    world.steps(24 + static_cast<int>(random() % 240));
    w.start = settled(w.scene, world.state);
    const Method best = kind == Kind::kSmooth ? Method::kRk : Method::kShake;
    const auto end = [&](double rate) {
      return runOf(w.scene, best, 1 / rate, 0, kWindow, &w.start).x;
    };
    w.exact = end(16000);
    w.uncertain = std::max(distance(w.exact, end(8000)), 0.25 * distance(w.exact, end(4000)));
    windows.push_back(w);
  }
  return windows;
}

/// Windows that a reference knows well enough: a fork is none; those whose error is within three
/// times what the tolerance allows; those in which it is not, and nothing was told.
struct Count {
  int known = 0, kept = 0, silent = 0;
  long parts = 0;
};

/// How a window is run.
struct Way {
  Method method;
  bool events;
};

void count(const std::vector<Window>& windows, Way way, double tolerance, Count& all) {
  for (const Window& w : windows) {
    if (w.uncertain > 0.3 * tolerance * kWindow) continue;
    const Outcome run =
        runOf(w.scene, way.method, kWindow / 6, tolerance, kWindow, &w.start, way.events);
    const bool kept = distance(run.x, w.exact) < 3 * tolerance * kWindow;
    ++all.known;
    all.kept += kept;
    all.silent += !kept && run.report.tolerance_missed == 0;
    all.parts += run.parts;
  }
}

void keepsTo95Of100(const std::vector<std::vector<Window>>& windows, int least_known) {
  for (const Way way : {Way{Method::kShake, false}, {Method::kRk, false}, {Method::kRk, true}})
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
      Count all;
      for (const std::vector<Window>& some : windows) count(some, way, tolerance, all);
      SCOPED_TRACE(tolerance);
      EXPECT_GE(all.known, least_known);
      EXPECT_LE(all.known - all.kept, std::ceil(0.05 * all.known));
      EXPECT_LE(all.silent, 0.05 * all.known);
      std::printf("%g: %d of %d, %d not told, %.0f parts per second\n", tolerance, all.kept,
                  all.known, all.silent, all.parts / (kWindow * all.known));
    }
}

TEST(Tolerance, IsKeptIn95Of100WindowsOfAllKinds) {
  std::vector<std::vector<Window>> windows;
  for (const Kind kind : {Kind::kSmooth, Kind::kLimits, Kind::kContact, Kind::kDamped})
    windows.push_back(windowsOf(kind, 20));
  keepsTo95Of100(windows, 30);
}

TEST(Tolerance, IsKeptIn95Of100WindowsOfContactAlone) {
  keepsTo95Of100({windowsOf(Kind::kContact, 80)}, 20);
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
        const Outcome run = runOf(scene, Method::kShake, 1.0 / 60, tolerance, kSeconds);
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
  const Outcome run = runOf(scene, Method::kShake, 1.0 / 60, kTolerance, kSeconds);
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
  const Outcome one = runOf(scene, Method::kShake, 1.0 / 60, 1e-3, 0.6);
  scene.solver.threads = 3;
  const Outcome three = runOf(scene, Method::kShake, 1.0 / 60, 1e-3, 0.6);
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
  const Outcome run = runOf(scene, Method::kShake, 1.0 / 60, 1e-2, 0.2);
  EXPECT_GT(run.report.error_estimate, 0);
  EXPECT_EQ(runOf(scene, Method::kShake, 1.0 / 60, 0, 0.2).report.error_estimate, 0);
}

}  // namespace
}  // namespace ragdoll
