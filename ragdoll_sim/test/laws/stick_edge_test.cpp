// A stick that meets a box: across an edge at one point, over a face along all of it.
#include <gtest/gtest.h>

#include <cmath>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/ends.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

constexpr double kStickRadius = 0.06;

/// A frictionless box whose upper edge along y passes through the origin.
ObstacleSpec boxWithAnEdge(double restitution) {
  ObstacleSpec o;
  o.type = ObstacleSpec::Type::kBox;
  o.size = Vec3(2, 2, 2);
  o.pose.position = Vec3(-1, 0, -1);
  o.restitution = restitution;
  return o;
}

/// A stick at 45 degrees across that edge, `off` [m] its middle along it, that comes at 2 m/s.
Scene stickAcrossAnEdge(double off, double restitution, double rate) {
  Scene scene = sceneOf(oneStick(1, 1, kStickRadius));
  const Vec3 along = Vec3(1, 0, -1).normalized(), normal = Vec3(1, 0, 1).normalized();
  RagdollSpec& r = scene.ragdolls[0];
  r.pose.orientation = Quat::FromTwoVectors(Vec3::UnitX(), along);
  r.pose.position = (off - 0.5) * along + (kStickRadius + 0.137) * normal;
  r.velocity = -2 * normal;
  scene.gravity.setZero();
  scene.obstacles = {boxWithAnEdge(restitution)};
  scene.solver.step = 1 / rate;
  return scene;
}

TEST(StickAcrossAnEdge, IsPushedWhereItTouches) {
  for (const double rate : {60.0, 240.0, 1000.0})
    for (const double restitution : {0.0, 0.5})
      for (const double off : {0.0, 0.1, 0.25}) {
        World world(stickAcrossAnEdge(off, restitution, rate));
        world.steps(static_cast<int>(0.1 * rate));  // 31 ms after the touch
        // Two masses of 1 kg, each 0.5 m from the middle: of the impulse J at `off` each gets the
        // half and what turns.
        const double J = (1 + restitution) * 2 / (0.5 + off * off / 0.5);
        const Vec3 normal = Vec3(1, 0, 1).normalized();
        const double a = -2 + J * (0.5 + off), b = -2 + J * (0.5 - off);
        // The stick has turned a little since: compare what it cannot change.
        const double spin = (world.v(0) - world.v(1)).norm(), mean = 0.5 * (a + b);
        EXPECT_NEAR(spin, a - b, 6e-3) << rate << " " << restitution << " " << off;
        EXPECT_NEAR((0.5 * (world.v(0) + world.v(1))).dot(normal), mean, 6e-3)
            << rate << " " << restitution << " " << off;
      }
}

/// A rod slides and rolls across a box's edge: at the end of a step it neither opens nor goes in. By
/// the plane where the motion leads before the edge presses it was 4e-5 m and 2.6e-4 m/s off at 120 Hz.
TEST(StickAcrossAnEdge, EndsAStepAlongTheEdge) {
  constexpr double kSeconds = 0.4;
  const Scene scene = parseScene(R"(
ragdolls:
  - {position: [0, 0, 0.54], rpy_deg: [0, 10, 30], velocity: [0, 0.4, 0],
     model: {sticks: [[p, q]], particles: {p: {position: [-0.5, 0, 0], mass: 1, radius: 0.03},
       q: {position: [0.5, 0, 0], mass: 1.1, radius: 0.03}}}}
obstacles: [{type: box, position: [-0.5, 0, 0], size: [1, 4, 1], friction: 0.3}]
)");
  const State exact = stateOfImpacts(scene, Method::kRk, 1.0 / 1920, kSeconds);
  for (const double rate : {120.0, 240.0, 480.0}) {
    const State end = stateOfImpacts(scene, Method::kShake, 1 / rate, kSeconds);
    EXPECT_LT(largest(end.x - exact.x), 0.15 / (rate * rate)) << rate;
    EXPECT_LT(largest(end.v - exact.v), 0.3 / (rate * rate)) << rate;
  }
}

TEST(StickOverAFace, RestsOnBothEndsOfWhatLiesOnIt) {
  for (const double over : {0.2, 0.45}) {  // of it is beyond the edge
    Scene scene = sceneOf(oneStick(1, 1, kStickRadius), Vec3(over - 1, 0, kStickRadius));
    scene.obstacles = {boxWithAnEdge(0)};
    World world(scene);
    world.steps(240);
    EXPECT_NEAR(world.x(0).z(), kStickRadius, 1e-6);
    EXPECT_NEAR(world.x(1).z(), kStickRadius, 1e-6);
  }
  Scene scene = sceneOf(oneStick(1, 1, kStickRadius), Vec3(0.55 - 1, 0, kStickRadius));
  scene.obstacles = {boxWithAnEdge(0)};
  World world(scene);
  world.steps(30);
  EXPECT_LT(world.x(1).z(), 0.05);  // its middle is beyond the edge: it tips
}

}  // namespace
}  // namespace ragdoll
