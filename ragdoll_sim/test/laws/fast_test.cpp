// What the fast method keeps (docs/fast.md): the same bits in any pack, lengths, momentum, order of
// the free motion, the laws of contact to first order, quality over random falls; and what it hands
// on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/step/workspace.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "support/double_pendulum.h"
#include "support/falls.h"

namespace ragdoll {
namespace {

using namespace test;

Scene fastScene(const std::string& text) {
  Scene scene = parseScene(text, "test");
  scene.solver = SolverSpec();
  scene.solver.method = Method::kFast;
  scene.solver.step = 1.0 / 60;
  return scene;
}

/// Humans that fall side by side, each as it likes.
Scene crowd(int bodies, Numbers numbers) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  Scene scene = fastScene(
      "ragdolls: [{model: human}]\nobstacles: [{type: plane, friction: 0.5}, {type: box, position: "
      "[0.3, 0.2, 0.2], size: [0.5, 0.5, 0.4]}]\n");
  scene.solver.numbers = numbers;
  scene.solver.joint_damping = 1;
  const RagdollSpec human = scene.ragdolls[0];
  scene.ragdolls.clear();
  for (int i = 0; i < bodies; ++i) {
    RagdollSpec r = human;
    r.name = "human" + std::to_string(i);
    r.pose.orientation = Quat(unit(random), unit(random), unit(random), unit(random)).normalized();
    r.pose.position = Vec3(0.1 * i, 0, 1.2 + 0.1 * i);
    r.velocity = Vec3(unit(random), unit(random), unit(random));
    scene.ragdolls.push_back(r);
  }
  return scene;
}

State fastAfter(const Scene& scene, int steps, int most_lanes = 0) {
  World world(scene);
  world.workspace.impl().fast.most_lanes = most_lanes;
  world.steps(steps);
  return world.state;
}

class FastBits : public testing::TestWithParam<Numbers> {};

TEST_P(FastBits, AreTheSameInPacksOfAnyWidth) {
  const Scene scene = crowd(19, GetParam());
  const State wide = fastAfter(scene, 90);
  EXPECT_TRUE(wide.x.allFinite());
  for (const int lanes : {1, 2, 4, 8})
    EXPECT_EQ(hash(fastAfter(scene, 90, lanes)), hash(wide)) << lanes;
}

TEST_P(FastBits, DoNotDependOnTheNeighbours) {
  Scene scene = crowd(11, GetParam());
  const State together = fastAfter(scene, 90);
  const RagdollSpec last = scene.ragdolls.back();
  const Eigen::Index n = together.x.cols() / 11;
  scene.ragdolls = {last};
  EXPECT_EQ(fastAfter(scene, 90).x, together.x.rightCols(n));
}

INSTANTIATE_TEST_SUITE_P(Numbers, FastBits, testing::Values(Numbers::kDouble, Numbers::kFloat));

TEST(Fast, FallsFreely) {
  Scene scene = fastScene("ragdolls: [{model: human, velocity: [1, 0, 2]}]\n");
  World world(scene);
  const Points start = world.state.x;
  EXPECT_EQ(world.steps(60).fast_fallbacks, 0);
  const Points fallen = start.colwise() + Vec3(1, 0, 2 - 0.5 * 9.81);
  EXPECT_LT((world.state.x - fallen).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((world.state.v.colwise() - Vec3(1, 0, 2 - 9.81)).cwiseAbs().maxCoeff(), 1e-12);
}

const char* const kFastTumble =
    "ragdolls: [{model: human, position: [0, 0, 3], angular_velocity: [1, 2, 0.5]}]\n"
    "gravity: [0, 0, 0]\n";

TEST(Fast, KeepsLengthsAndMomentaInTheAir) {
  World world(fastScene(kFastTumble));
  const Vec3 spin = angularMomentum(world.model, world.state);
  world.steps(300);
  EXPECT_LT(maxStickError(world.model, world.state), 1e-13);
  EXPECT_LT(momentum(world.model, world.state).norm(), 1e-10);
  EXPECT_LT((angularMomentum(world.model, world.state) - spin).norm(), 1e-8 * spin.norm());
}

/// Rounds that ended at one turn left at any step made it of first order: 6 mm off at 1000 Hz.
TEST(Fast, ADoublePendulumIsOfSecondOrder) {
  const Vec3 exact = double_pendulum::tipByLagrangian(65536);
  for (const auto& [rate, most] : {std::pair(240, 9e-4), {1000, 6e-5}, {4000, 4e-6}}) {
    World world(double_pendulum::pendulum(Method::kFast, 1.0 / rate));
    world.steps(rate);
    EXPECT_LT((world.state.x.col(2) - exact).norm(), most) << rate;
  }
}

/// [m] RMS from rk after some time of a motion that no limit meets.
double freeError(const char* text, double seconds, double rate) {
  Scene scene = fastScene(text);
  for (RagdollSpec& r : scene.ragdolls) {
    auto free = std::make_shared<SkeletonSpec>(*r.skeleton);
    free->joints.clear();
    r.skeleton = free;
  }
  Scene exact = scene;
  exact.solver.method = Method::kRk;
  exact.solver.step = 1e-3;
  const Points reference = fastAfter(exact, static_cast<int>(std::lround(1e3 * seconds))).x;
  scene.solver.step = 1 / rate;
  const Points ours = fastAfter(scene, static_cast<int>(std::lround(seconds * rate))).x;
  return std::sqrt((ours - reference).colwise().squaredNorm().mean());
}

TEST(Fast, IsOfSecondOrderInTheAir) {
  const double coarse = freeError(kFastTumble, 0.3, 60), fine = freeError(kFastTumble, 0.3, 120);
  EXPECT_LT(coarse, 5e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
}

/// Lies in the air on its side, held by a hand, and swings.
const char* const kFastSwing =
    "ragdolls: [{model: human, position: [0, 0, 2], rpy_deg: [-90, 0, 0]}]\npins: [right_hand]\n";

TEST(Fast, IsOfSecondOrderOnAPin) {
  const double coarse = freeError(kFastSwing, 0.5, 240), fine = freeError(kFastSwing, 0.5, 480);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
}

/// Steps of 1/60 s are too long for limbs without limits: what misses energy is made again in
/// parts.
TEST(Fast, FollowsLimbsThatWhip) { EXPECT_LT(freeError(kFastSwing, 1, 60), 0.06); }

/// [m/s] The fastest change of a stick's length.
double fastestStretch(const World& world) {
  double most = 0;
  for (const Stick& k : world.model.skeletonOf(world.model.ragdolls[0]).sticks) {
    const Vec3 along = (world.x(k.a) - world.x(k.b)).normalized();
    most = std::max(most, std::abs(along.dot(world.state.v.col(k.a) - world.state.v.col(k.b))));
  }
  return most;
}

TEST(Fast, HangsByAPin) {
  World world(fastScene(kFastSwing));
  const int hand = world.model.pins[0].particle;
  const Vec3 held = world.x(hand);
  const double start = potentialEnergy(world.model, world.state);
  for (int i = 0; i < 180; ++i) {
    world.steps(1);
    ASSERT_LT(kineticEnergy(world.model, world.state) + potentialEnergy(world.model, world.state),
              start + 0.5)
        << i;
    ASSERT_LT(fastestStretch(world), 1e-10) << i;
  }
  EXPECT_LT((world.x(hand) - held).norm(), 1e-12);
  EXPECT_EQ(Vec3(world.state.v.col(hand)), Vec3(0, 0, 0));
  EXPECT_LT(maxStickError(world.model, world.state), 1e-13);
}

/// A pin that is led on at 1 m/s, in steps whose limbs whip: it goes as far in every part of one.
TEST(Fast, GoesWhereItsPinIsLed) {
  World world(fastScene(kFastSwing));
  const int hand = world.model.pins[0].particle;
  const double h = world.model.solver.step;
  world.inputs.pins = {world.x(hand)};
  for (int i = 0; i < 120; ++i) {
    world.inputs.pins[0].x() += h;
    world.steps(1);
    ASSERT_LT((world.x(hand) - world.inputs.pins[0]).norm(), 1e-12) << i;
    ASSERT_LT((world.state.v.col(hand) - Vec3::UnitX()).norm(), 1e-9) << i;
  }
}

/// Limbs that run into their limits while the body swings or tumbles: no step gains more than what
/// leapfrog's energy swings by.
TEST(Fast, LimitsGiveNoEnergyToWhatSwingsOrTumbles) {
  for (const char* text :
       {"ragdolls: [{model: human, position: [0, 0, 2], rpy_deg: [0, 60, 0]}]\npins: "
        "[right_hand]\n",
        "ragdolls: [{model: human, angular_velocity: [6, -4, 5]}]\ngravity: [0, 0, 0]\n"}) {
    World world(fastScene(text));
    const auto energy = [&] {
      return kineticEnergy(world.model, world.state) + potentialEnergy(world.model, world.state);
    };
    double last = energy(), rise = 0, most = 0;
    for (int i = 0; i < 600; ++i) {
      world.steps(1);
      rise = std::max(rise, energy() - last);
      last = energy();
      most = std::max(most, kineticEnergy(world.model, world.state));
    }
    EXPECT_LT(rise, 4e-3 * most) << text;  // [J]
  }
}

TEST(Fast, SlidesAsFarAsFrictionLetsIt) {
  Scene scene =
      fastScene("ragdolls: [{model: human}]\nobstacles: [{type: plane, friction: 0.4}]\n");
  scene.ragdolls[0].skeleton = std::make_shared<const SkeletonSpec>(oneStick(1, 1, 0.1));
  scene.ragdolls[0].pose.position = Vec3(0, 0, 0.1);
  scene.ragdolls[0].velocity = Vec3(0, 2, 0);
  World world(scene);
  world.steps(120);
  EXPECT_NEAR(world.x(0).y(), 2 * 2 / (2 * 0.4 * 9.81), 0.02);
  EXPECT_NEAR(world.x(0).z(), 0.1, 1e-3);
  EXPECT_LT(world.v(0).norm(), 1e-6);
}

TEST(Fast, BouncesToFirstOrder) {
  Scene scene = fastScene(
      "ragdolls: [{model: human}]\nobstacles: [{type: plane, friction: 0, restitution: 0.5}]\n");
  scene.ragdolls[0].skeleton = std::make_shared<const SkeletonSpec>(oneParticle(1, 0.1));
  scene.ragdolls[0].pose.position = Vec3(0, 0, 1.1);
  World world(scene);
  double highest = 0;
  for (int i = 0; i < 60; ++i) {
    world.steps(1);
    if (i > 30) highest = std::max(highest, world.x(0).z() - 0.1);
  }
  EXPECT_NEAR(highest, 0.25, 0.06);
}

TEST(Fast, ComesToRestAndSleeps) {
  Scene scene = fastScene(
      "ragdolls: [{model: human, position: [0, 0, 1.5], rpy_deg: [20, 60, 0]}]\n"
      "obstacles: [{type: plane, friction: 0.6}]\n");
  scene.solver.joint_damping = 2;
  World world(scene);
  world.steps(600);
  EXPECT_TRUE(world.state.asleep[0]);
}

/// As the direct methods do: who tells of forces or takes the body over need not know who pressed.
TEST(Fast, KeepsHalfOfTheForceThatPresses) {
  Scene scene = fastScene(
      "ragdolls: [{model: {particles: {p: {position: [0, 0, 0.1], radius: 0.1, mass: 2}}}}]\n"
      "obstacles: [{type: plane}]\n");
  scene.solver.sleep = false;
  for (const Method method : {Method::kFast, Method::kShake}) {
    scene.solver.method = method;
    World world(scene);
    world.steps(30);
    Vec3 kept = Vec3::Zero();
    for (const CachedImpulse& last : world.state.impulses) kept += last.impulse;
    EXPECT_NEAR(kept.z(), 0.5 * 2 * 9.81, 1e-6);
  }
}

TEST(Fast, HandsOnWhatIsNotForIt) {
  SkeletonSpec square = oneParticle();
  square.particles = {particle("a", {0, 0, 0}), particle("b", {1, 0, 0}), particle("c", {1, 1, 0}),
                      particle("d", {0, 1, 0})};
  square.sticks = {stick("a", "b"), stick("b", "c"), stick("c", "d"), stick("d", "a")};
  Scene scene = fastScene("ragdolls: [{model: human}]\n");
  scene.ragdolls[0].skeleton = std::make_shared<const SkeletonSpec>(square);
  World loop(scene);
  EXPECT_EQ(loop.steps(1).fast_fallbacks, 1);
  World two(fastScene("ragdolls: [{model: human}]\npins: [left_hand, right_hand]\n"));
  EXPECT_EQ(two.steps(1).fast_fallbacks, 1);
  Scene soft = crowd(2, Numbers::kDouble);
  soft.obstacles[0].contact.stiffness = 1e4;
  World crowded(soft);
  EXPECT_EQ(crowded.steps(1).fast_fallbacks, 2);
}

/// Humans in one place that fall through each other, alike; the first one may be held by a pin.
World inOnePlace(int bodies, bool pinned) {
  Scene scene = fastScene(
      "ragdolls: [{model: human, position: [0, 0, 1.3], rpy_deg: [20, 70, 0], angular_velocity: "
      "[90, 60, 30]}]\nobstacles: [{type: plane, friction: 0.5}]\n");
  const RagdollSpec human = scene.ragdolls[0];
  scene.ragdolls.clear();
  for (int i = 0; i < bodies; ++i) {
    scene.ragdolls.push_back(human);
    scene.ragdolls[i].name = "human" + std::to_string(i);
  }
  if (pinned) {
    scene.pins = {pinOf("human0/left_hand")};
  }
  return World(scene);
}

/// What is handed on has a thread's scratch in turn: nothing of the body before is left in it.
TEST(Fast, HandsOnBodiesInOnePlaceAsEachAlone) {
  for (const bool pinned : {false, true}) {
    World all = inOnePlace(3, pinned), one = inOnePlace(1, pinned), other = inOnePlace(1, false);
    const Eigen::Index n = one.state.x.cols();
    int handed_on = 0;
    for (int i = 0; i < 60; ++i) {
      handed_on += all.steps(1).fast_fallbacks;
      one.steps(1);
      other.steps(1);
      ASSERT_EQ(all.state.x.leftCols(n), one.state.x) << pinned << ", step " << i;
      for (int k = 1; k < 3; ++k)
        ASSERT_EQ(all.state.x.middleCols(k * n, n), other.state.x) << pinned << ", step " << i;
    }
    EXPECT_GT(handed_on, 3);
  }
}

/// As preset fast has it, damped as shipped.
Scene fastFall(const std::string& name, std::mt19937& random) {
  Scene scene = randomFall(name, random);
  const double damping = scene.solver.joint_damping;
  scene.solver = preset("fast");
  scene.solver.joint_damping = damping;
  return scene;
}

/// The worse of both, and how many came to rest.
void addRecord(const FallRecord& one, FallRecord& all) {
  for (double FallRecord::*value :
       {&FallRecord::limit_deg, &FallRecord::stretch, &FallRecord::penetration_mm,
        &FallRecord::stick_mm, &FallRecord::rise, &FallRecord::step_rise})
    all.*value = std::max(all.*value, one.*value);
  all.resting += one.resting;
}

class FastFalls : public testing::TestWithParam<std::string> {};

TEST_P(FastFalls, HoldTheBodyTogetherAndEndAtRest) {
  constexpr int kFalls = samples(100);
  std::mt19937 random(2007);
  FallRecord record;
  std::vector<double> deepest, farthest;
  for (int fall = 0; fall < kFalls; ++fall) {
    FallRecord one;
    addFall(fastFall(GetParam(), random), 10, one);
    deepest.push_back(one.penetration_mm);
    farthest.push_back(one.limit_deg);
    addRecord(one, record);
  }
  for (std::vector<double>* all : {&deepest, &farthest}) std::sort(all->begin(), all->end());
  RecordProperty("limit_deg", std::to_string(record.limit_deg));
  RecordProperty("penetration_mm", std::to_string(record.penetration_mm));
  RecordProperty("median_penetration_mm", std::to_string(deepest[kFalls / 2]));
  RecordProperty("stick_mm", std::to_string(record.stick_mm));
  RecordProperty("step_rise_J", std::to_string(record.step_rise));
  EXPECT_LT(record.stretch, 1e-9);
  EXPECT_LT(farthest[kFalls / 2], 2);
  EXPECT_LT(record.limit_deg, 10);
  EXPECT_LT(deepest[kFalls / 2], 1);
  EXPECT_LT(record.penetration_mm, 15);
  EXPECT_LT(record.stick_mm, 20);
  EXPECT_LT(record.rise, 1);
  EXPECT_LT(record.step_rise, 1);
  EXPECT_GE(record.resting, 99 * kFalls / 100);
}

/// Hips whose regions are wider than a half turn. As cones of that width, which are
/// wider, bodies rested up to 9 degrees beyond them (5 in half of the falls, on the way there).
TEST(Fast, KeepsWideRegions) {
  constexpr int kFalls = 20;
  std::mt19937 random(2026);
  std::vector<double> worst, resting;
  const auto thesis = parseScene("ragdolls: [{model: human_thesis}]\n").ragdolls[0].skeleton;
  for (int fall = 0; fall < kFalls; ++fall) {
    Scene scene = fastFall("fall", random);
    scene.ragdolls[0].skeleton = thesis;
    World world(scene);
    worst.push_back(0);
    while (world.state.time < 6) {
      world.steps(1);
      worst.back() = std::max(worst.back(), maxLimitViolation(world.model, world.state));
    }
    resting.push_back(maxLimitViolation(world.model, world.state));
  }
  std::sort(worst.begin(), worst.end());
  EXPECT_LT(worst[kFalls / 2], 0.035);  // [rad]
  EXPECT_LT(worst.back(), 0.17);
  EXPECT_LT(*std::max_element(resting.begin(), resting.end()), 0.01);
}

TEST_P(FastFalls, KeepFastBodiesOut) {
  constexpr int kFalls = samples(100);
  std::mt19937 random(2007);
  std::uniform_real_distribution<double> unit(-1, 1);
  FallRecord record;
  for (int fall = 0; fall < kFalls; ++fall) {
    Scene scene = fastFall(GetParam(), random);
    scene.ragdolls[0].velocity = 10 * Vec3(unit(random), unit(random), -1).normalized();
    addFall(scene, 2, record);
  }
  EXPECT_LT(record.penetration_mm, 15);
  EXPECT_LT(record.stick_mm, 30);
  EXPECT_LT(record.step_rise, 1);
}

INSTANTIATE_TEST_SUITE_P(Scenes, FastFalls, testing::Values("fall", "stairs", "between_objects"));

}  // namespace
}  // namespace ragdoll
