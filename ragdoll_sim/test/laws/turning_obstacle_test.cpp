// What an obstacle that turns does: its surface moves along arcs, so its velocity where it is
// touched is not that of the step's chord.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

/// An obstacle, number 0, that moves and turns evenly from its place on.
struct Turning {
  Vec3 speed = Vec3::Zero(), spin = Vec3::Zero();  ///< [m/s], [rad/s]

  Eigen::Quaterniond turnAt(double time) const {
    return Eigen::Quaterniond(Eigen::AngleAxisd(time * spin.norm(), spin.normalized()));
  }
  Pose poseAt(const Pose& start, double time) const {
    return {start.position + time * speed, turnAt(time) * start.orientation};
  }
};

/// The state after so many seconds at `rate` steps a second.
State after(const std::string& text, const Turning& obstacle, Method method, double rate,
            double seconds) {
  Scene scene = parseScene(text);
  scene.solver.method = method;
  scene.solver.step = 1 / rate;
  scene.solver.sleep = false;
  World world(scene);
  world.inputs.obstacles = world.state.obstacles;
  const Pose start = world.state.obstacles[0];
  for (int i = 1; i <= std::lround(seconds * rate); ++i) {
    world.inputs.obstacles[0] = obstacle.poseAt(start, i / rate);
    world.steps(1);
  }
  return world.state;
}

/// A ball falls onto a box of half height 0.2 m at the origin, without friction; in closed form:
/// its free way, when that meets the face that turns, Newton's impact law there.
struct Fall {
  Vec3 place{0.06, 0, 0.3837}, velocity{1, 0, -1.4}, gravity{0, 0, -9.81};
  double radius = 0.05, restitution = 0.5;
  Turning box;

  Vec3 at(double t) const { return place + t * velocity + 0.5 * t * t * gravity; }
  Vec3 normalAt(double t) const { return box.turnAt(t) * Vec3::UnitZ(); }
  double gapAt(double t) const { return normalAt(t).dot(at(t) - t * box.speed) - 0.2 - radius; }
  Vec3 endAt(double seconds) const {
    double open = 0, closed = seconds;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (open + closed);
      (gapAt(middle) > 0 ? open : closed) = middle;
    }
    const Vec3 n = normalAt(open), arm = at(open) - open * box.speed - radius * n;
    const Vec3 surface = box.speed + box.spin.cross(arm);
    const Vec3 before = velocity + open * gravity;
    const Vec3 thrown = before - (1 + restitution) * n.dot(before - surface) * n;
    const double left = seconds - open;
    return at(open) + left * thrown + 0.5 * left * left * gravity;
  }
};

/// 1.1e-2 m off at 60 Hz and 1.7e-4 m at 4000 Hz by the chord, and by the plane of the step's end.
TEST(TurningObstacle, ThrowsABall) {
  const std::string text = R"(
ragdolls: [{position: [0.06, 0, 0.3837], velocity: [1, 0, -1.4],
            model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.05}}}}]
obstacles: [{type: box, position: [0, 0, 0], size: [0.6, 0.6, 0.4], restitution: 0.5, friction: 0}]
)";
  Fall fall;
  for (const Vec3& speed : {Vec3(0, 0, 0), Vec3(0.2, 0.1, 0.3)})
    for (const Vec3& spin : {Vec3(0.3, 2, 0.5), Vec3(0.3, -2, 0.5)}) {
      fall.box = {speed, spin};
      const Vec3 exact = fall.endAt(0.2);
      for (const Method method : {Method::kShake, Method::kRk})
        for (const double rate : {60.0, 250.0, 1000.0, 4000.0}) {
          const State state = after(text, fall.box, method, rate, 0.2);
          EXPECT_LT((state.x.col(0) - exact).norm(), 0.08 / (rate * rate) + 1e-7)
              << rate << " Hz, spin " << spin.transpose();
        }
    }
}

/// A turntable carries a ball that stands on it on a circle. By the chord's velocity it drags
/// inwards.
TEST(TurningObstacle, CarriesWhatStandsOnIt) {
  const double spin = 2, radius = 0.2, seconds = 0.4;
  const std::string text = R"(
ragdolls: [{position: [0.2, 0, 0.05], velocity: [0, 0.4, 0],
            model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.05}}}}]
obstacles: [{type: box, position: [0, 0, -0.1], size: [2, 2, 0.2], friction: 0.9}]
)";
  const Vec3 exact(radius * std::cos(spin * seconds), radius * std::sin(spin * seconds), 0.05);
  for (const double rate : {60.0, 250.0, 1000.0, 4000.0}) {
    const State state = after(text, {Vec3::Zero(), {0, 0, spin}}, Method::kShake, rate, seconds);
    EXPECT_LT((state.x.col(0) - exact).norm(), 0.3 / (rate * rate)) << rate;
    const Vec3 v = Vec3(0, 0, spin).cross(exact);
    EXPECT_LT((state.v.col(0) - v).norm(), 1 / (rate * rate)) << rate;
  }
}

/// A tumbling rod that a turning box hits: second order, to `rk`'s limit.
TEST(TurningObstacle, HitsARod) {
  const std::string text = R"(
ragdolls: [{position: [0.06, 0.1, 0.45], velocity: [0.5, 0, -1.4], angular_velocity: [0.5, 3, 0],
  model: {sticks: [[p, q]], particles: {p: {position: [-0.3, 0, 0], mass: 1, radius: 0.03},
                                        q: {position: [0.3, 0, 0], mass: 1.3, radius: 0.03}}}}]
obstacles: [{type: box, position: [0, 0, 0], size: [0.3, 0.6, 0.4], restitution: 0.3, friction: 0.2}]
)";
  const Turning box{{0, 0, 0.2}, {0.3, 2, 0.5}};
  const Points exact = after(text, box, Method::kRk, 2000, 0.2).x;
  for (const double rate : {60.0, 250.0, 1000.0, 4000.0}) {
    const Points end = after(text, box, Method::kShake, rate, 0.2).x;
    EXPECT_LT((end - exact).colwise().norm().maxCoeff(), 0.5 / (rate * rate)) << rate;
  }
}

/// One that moves, 1e-7 m from what it hits as a step begins at 16000 Hz: 0.019 m off there, if
/// what is so near keeps the plane of the whole step.
TEST(TurningObstacle, MeetsWhatIsNearAsAStepBegins) {
  const std::string text = R"(
ragdolls: [{position: [0.06, 0, 0.3537], velocity: [1, 0, -1],
            model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.05}}}}]
obstacles: [{type: sphere, position: [0, 0, 0], radius: 0.2, restitution: 0.5, friction: 0.3}]
)";
  const Turning sphere{{0.3, 0.2, 0.5}, Vec3::Zero()};
  const Points exact = after(text, sphere, Method::kRk, 1000, 0.2).x;
  for (const double rate : {250.0, 4000.0, 16000.0})
    EXPECT_LT((after(text, sphere, Method::kShake, rate, 0.2).x - exact).norm(), 1e-8) << rate;
}

}  // namespace
}  // namespace ragdoll::test
