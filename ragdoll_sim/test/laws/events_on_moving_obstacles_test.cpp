// rk from event to event where obstacles move and pins are led: closed forms, one motion in any
// steps, and what is seen by whoever moves along.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/gravity.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

SolverSpec byEventsAt(double hz) {
  SolverSpec solver;
  solver.method = Method::kRk;
  solver.events = true;
  solver.step = 1 / hz;
  solver.sleep = false;
  return solver;
}

/// A scene whose obstacles and pins move evenly.
struct LedScene {
  std::string text;
  Vec3 obstacle = Vec3::Zero();  ///< [m/s] of the first obstacle
  Vec3 spin = Vec3::Zero();      ///< [rad/s] likewise, about its own point
  Vec3 pin = Vec3::Zero();       ///< [m/s] of the first pin
};

class LedWorld : public World {
 public:
  explicit LedWorld(const LedScene& led, double hz, Method method = Method::kRk)
      : World(sceneAt(led.text, hz, method)), led_(led), hz_(hz), start_(model.obstacles[0].pose) {
    for (const Pin& pin : model.pins) pins_.push_back(state.x.col(pin.particle));
  }
  void runTo(double time) {
    const int last = static_cast<int>(std::lround(time * hz_));
    while (step_ < last) {
      ++step_;
      inputs.obstacles.clear();
      for (const Obstacle& o : model.obstacles) inputs.obstacles.push_back(o.pose);
      inputs.obstacles[0] = poseAt(step_ / hz_);
      if (!pins_.empty()) {
        inputs.pins = pins_;
        inputs.pins[0] += step_ / hz_ * led_.pin;
      }
      handed_over += steps(1).handed_over;
    }
  }
  int handed_over = 0;

 private:
  static Scene sceneAt(const std::string& text, double hz, Method method) {
    Scene scene = parseScene(text);
    scene.solver = byEventsAt(hz);
    scene.solver.method = method;
    scene.solver.events = method == Method::kRk;
    return scene;
  }
  Pose poseAt(double time) const {
    Pose pose = start_;
    pose.position += time * led_.obstacle;
    const double angle = time * led_.spin.norm();
    if (angle > 0)
      pose.orientation = Quat(Eigen::AngleAxisd(angle, led_.spin.normalized())) * pose.orientation;
    return pose;
  }

  LedScene led_;
  double hz_;
  Pose start_;
  std::vector<Vec3> pins_;
  int step_ = 0;
};

const char* const kBlock =
    "ragdolls: [{position: [0, 0, 0.05], model: {particles: {p: {position: [0, 0, 0], mass: 2, "
    "radius: 0.05}}}}]\n";

/// Laid on a belt it slips until it is as fast.
TEST(EventsOnMovingObstacles, ABeltTakesABlockAlong) {
  constexpr double kSpeed = 1, kFriction = 0.5;
  for (const double hz : {60.0, 120.0}) {
    LedWorld world(
        {std::string(kBlock) + "obstacles: [{type: plane, friction: 0.5}]\n", Vec3(kSpeed, 0, 0)},
        hz);
    for (const double time : {0.1, 0.2, 0.5}) {
      world.runTo(time);
      const double slips = std::min(time, kSpeed / (kFriction * kG));
      const double way = 0.5 * kFriction * kG * slips * slips + kSpeed * (time - slips);
      EXPECT_NEAR(world.x(0).x(), way, 1e-9) << hz << " " << time;
      EXPECT_NEAR(world.x(0).z(), 0.05, 1e-9);
    }
    EXPECT_EQ(world.handed_over, 0);
  }
}

/// A belt that gains speed does so from step to step. At each of these what stands on it slips
/// until friction has made it as fast, which is before the next one.
TEST(EventsOnMovingObstacles, ABeltThatGainsSpeedLosesABlockByItsSteps) {
  constexpr double kGains = 1, kTime = 0.5, kSlows = 0.5 * kG;  // [m/s^2], [s], [m/s^2]
  for (const double hz : {60.0, 240.0}) {
    Scene scene = parseScene(std::string(kBlock) + "obstacles: [{type: plane, friction: 0.5}]\n");
    scene.solver = byEventsAt(hz);
    World world(scene);
    const int steps = static_cast<int>(std::lround(kTime * hz));
    double belt = 0, behind = 0;
    for (int i = 0; i < steps; ++i) {
      const double speed = kGains * (i + 1) / hz;  // over the step
      behind += std::pow(kGains / hz, 2) / (2 * kSlows);
      belt += speed / hz;
      world.inputs.obstacles = {world.model.obstacles[0].pose};
      world.inputs.obstacles[0].position.x() += belt;
      EXPECT_EQ(world.steps(1).handed_over, 0);
    }
    EXPECT_NEAR(belt - world.x(0).x(), behind, 1e-9) << hz;
  }
}

/// A ball falls onto a floor that rises: seen from there it falls faster.
TEST(EventsOnMovingObstacles, AFloorThatRisesThrowsABallBack) {
  constexpr double kRise = 0.7, kBack = 0.6, kHigh = 0.3;
  LedWorld world(
      {"ragdolls: [{position: [0, 0, 0.35], model: {particles: {p: {position: [0, 0, 0], mass: 2, "
       "radius: 0.05}}}}]\n"
       "obstacles: [{type: box, position: [0, 0, -0.5], size: [2, 2, 1], restitution: 0.6}]\n",
       Vec3(0, 0, kRise)},
      120);
  const double falls = (std::sqrt(kRise * kRise + 2 * kG * kHigh) - kRise) / kG;
  double time = falls, speed = kBack * (kRise + kG * falls);
  for (int bounce = 0; bounce < 2; ++bounce) {
    const double lasts = 2 * speed / kG;
    const double until = std::floor((time + 0.8 * lasts) * 120) / 120, t = until - time;
    world.runTo(until);
    EXPECT_NEAR(world.x(0).z() - 0.05 - kRise * until, speed * t - 0.5 * kG * t * t, 1e-9)
        << bounce;
    time += lasts;
    speed *= kBack;
  }
  EXPECT_EQ(world.handed_over, 0);
}

/// What is rough enough goes round with a disc.
TEST(EventsOnMovingObstacles, ADiscTakesAlongWhatSticks) {
  constexpr double kSpin = 2, kAway = 0.5;
  LedWorld world(
      {"ragdolls: [{position: [0.5, 0, 0.05], velocity: [0, 1, 0], model: {particles: {p: "
       "{position: [0, 0, 0], mass: 2, radius: 0.05}}}}]\nobstacles: [{type: box, position: [0, 0, "
       "-0.5], size: [2, 2, 1], "
       "friction: 0.3}]\n",
       Vec3::Zero(), Vec3(0, 0, kSpin)},
      60);
  for (const double time : {0.1, 0.5, 1.0}) {
    world.runTo(time);
    const Vec3 there(kAway * std::cos(kSpin * time), kAway * std::sin(kSpin * time), 0.05);
    EXPECT_LT((world.x(0) - there).norm(), 1e-9) << time;
  }
  EXPECT_EQ(world.handed_over, 0);
}

/// [m] Where a block is that slips on a disc, by a fourth-order formula in small steps.
Vec3 slippedOnDisc(Vec3 x, Vec3 v, double friction, const Vec3& spin, double time) {
  const int steps = static_cast<int>(std::lround(time / 1e-5));
  const double h = time / steps;
  const auto pull = [&](const Vec3& at, const Vec3& speed) -> Vec3 {
    return -friction * kG * (speed - spin.cross(at)).normalized();
  };
  for (int i = 0; i < steps; ++i) {
    const Vec3 a1 = pull(x, v), v2 = v + 0.5 * h * a1, a2 = pull(x + 0.5 * h * v, v2),
               v3 = v + 0.5 * h * a2, a3 = pull(x + 0.5 * h * v2, v3), v4 = v + h * a3,
               a4 = pull(x + h * v3, v4);
    x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return x;
}

TEST(EventsOnMovingObstacles, ADiscTurnsWhatSlips) {
  const Vec3 spin(0, 0, 3), start(0.3, 0.1, 0), speed(0.4, -0.2, 0);
  LedWorld world(
      {"ragdolls: [{position: [0.3, 0.1, 0.05], velocity: [0.4, -0.2, 0], model: {particles: {p: "
       "{position: [0, 0, 0], mass: 2, radius: 0.05}}}}]\nobstacles: [{type: box, position: [0, 0, "
       "-0.5], size: [3, 3, "
       "1], friction: 0.15}]\n",
       Vec3::Zero(), spin},
      60);
  world.runTo(0.4);
  const Vec3 there = slippedOnDisc(start, speed, 0.15, spin, 0.4);
  EXPECT_LT((world.x(0) - there - Vec3(0, 0, 0.05)).norm(), 1e-9);
  EXPECT_EQ(world.handed_over, 0);
}

/// A jointed body that is led by a hand over what stands there. Its pin sets off at once, or stands
/// still and all else comes: either way what hangs on it goes along at once.
LedScene draggedHuman(bool moves) {
  const std::string velocity = moves ? "[0.8, -0.1, 0]" : "[0, 0, 0]";
  return {"ragdolls: [{model: human, position: [0, 0, 0.9], rpy_deg: [0, 80, 0], velocity: " +
              velocity +
              "}]\npins: [right_hand]\nobstacles: [{type: box, position: [0.2, 0, 0.2], size: "
              "[0.4, 3, 0.8], rpy_deg: [0, 20, 0], friction: 0.4}]\n",
          moves ? Vec3(0.8, -0.1, 0) : Vec3(0, 0, 0), Vec3::Zero(),
          moves ? Vec3(0, 0, 0) : Vec3(-0.8, 0.1, 0)};
}

/// Whoever moves evenly sees the same.
TEST(EventsOnMovingObstacles, AreThoseOfAPinThatMoves) {
  constexpr double kTime = 0.3;
  LedWorld moves(draggedHuman(true), 240), led(draggedHuman(false), 240);
  moves.runTo(kTime);
  led.runTo(kTime);
  const Points seen = moves.state.x.colwise() + kTime * Vec3(-0.8, 0.1, 0);
  EXPECT_LT((led.state.x - seen).colwise().norm().maxCoeff(), 1e-8);
  EXPECT_EQ(moves.handed_over, 0);
  EXPECT_EQ(led.handed_over, 0);
}

/// A drum that turns and comes along strikes and drags a human that falls onto it.
const char* const kDrum =
    "ragdolls: [{model: human, position: [0.1, 0.2, 1.0], rpy_deg: [70, 20, 30], velocity: [0, 0, "
    "-2]}]\nobstacles: [{type: capsule, from: [-1, 0, 0.2], to: [1, 0, 0.2], radius: 0.3, "
    "friction: 0.5, restitution: 0.3}]\n";

TEST(EventsOnMovingObstacles, AreOfFifthOrderOnADrum) {
  const LedScene drum{kDrum, Vec3(0.1, -0.5, 0.2), Vec3(3, 0.5, -0.4)};
  constexpr double kTime = 0.4;
  LedWorld fine(drum, 2000), coarse(drum, 250), shake(drum, 8000, Method::kShake);
  for (LedWorld* world : {&fine, &coarse, &shake}) world->runTo(kTime);
  const auto apart = [&](const LedWorld& world) {
    return (world.state.x - fine.state.x).colwise().norm().maxCoeff();
  };
  EXPECT_LT(apart(coarse), 1e-7);
  EXPECT_LT(apart(shake), 1e-4);
  EXPECT_EQ(fine.handed_over + coarse.handed_over, 0);
}

}  // namespace
}  // namespace ragdoll::test
