// What a motion touches and leaves again before its end: gaps at both ends do not show it. In
// closed form: a blow takes the speed at which it is reached, and what is tangent goes on.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ragdoll_sim/io/scene_yaml.h"
#include "support/ends.h"

namespace ragdoll::test {
namespace {

constexpr double kApart = 0.25;  // [m] between the centres where they touch
constexpr double kSeconds = 0.2;

/// A ball at 4 m/s whose way leads `deep` [m] into a sphere `from` [m] away that stands still or,
/// as heavy as it, flies against it at 1 of the 4 m/s.
std::string ballsThatGraze(double from, double deep, bool moves) {
  const std::string ball = "{name: a, position: [" + std::to_string(-from) + ", 0, " +
                           std::to_string(kApart - deep) + "], velocity: [" + (moves ? "3" : "4") +
                           ", 0, 0], model: {particles: {p: {position: [0, 0, 0], mass: 1, "
                           "radius: 0.05}}}}";
  const std::string other =
      moves ? ", {name: b, velocity: [-1, 0, 0], model: {particles: {p: {position: [0, 0, 0], "
              "mass: 1, radius: 0.2}}}}]"
            : "]\nobstacles: [{type: sphere, position: [0, 0, 0], radius: 0.2, friction: 0}]";
  return "gravity: [0, 0, 0]\nragdoll_collision: true\nragdolls: [" + ball + other;
}

/// [m] Where the first ball ends. Friction between two particles would turn them, which cannot
/// spin.
Vec3 endOfGraze(double from, double deep, bool moves) {
  const double height = kApart - deep, before = std::sqrt(kApart * kApart - height * height);
  const double time = (from - before) / 4;
  const Vec3 normal = Vec3(-before, 0, height) / kApart, velocity(moves ? 3 : 4, 0, 0);
  const Vec3 blow = -(moves ? 0.5 : 1) * normal.dot(Vec3(4, 0, 0)) * normal;
  return Vec3(-from, 0, height) + time * velocity + (kSeconds - time) * (velocity + blow);
}

double offAt(double rate, double from, double deep, bool moves, Method method,
             double tolerance = 0) {
  Scene scene = parseScene(ballsThatGraze(from, deep, moves));
  scene.solver.tolerance = tolerance;
  const Points end = endOfImpacts(scene, method, 1 / rate, kSeconds);
  return (end.col(0) - endOfGraze(from, deep, moves)).norm();
}

/// A blow slower than rest is pressed over its step: at 60 Hz those are up to 0.65 m/s. Where it is
/// not seen, 1e-2 m off at 250 Hz, and by rk at 60.
TEST(Graze, OfABallIsABlow) {
  for (const bool moves : {false, true})
    for (const double deep : {1e-5, 5e-5, 1e-4, 5e-4, 1e-3, 3e-3, 1e-2}) {
      for (const double rate : {60.0, 120.0})
        EXPECT_LT(offAt(rate, 0.31, deep, moves, Method::kShake), 1.5e-3) << rate << " " << deep;
      for (const double rate : {250.0, 1000.0, 4000.0})
        EXPECT_LT(offAt(rate, 0.31, deep, moves, Method::kShake), 1e-7) << rate << " " << deep;
      for (const double rate : {30.0, 60.0, 120.0})
        EXPECT_LT(offAt(rate, 0.31, deep, moves, Method::kRk), 1e-9) << rate << " " << deep;
    }
}

/// 230 times what 1e-4 m/s allows where it is not seen.
TEST(Graze, IsSeenWithinATolerance) {
  for (const bool moves : {false, true})
    for (const double from : {0.27, 0.28, 0.29, 0.30, 0.31, 0.32})
      for (const double deep : {1e-5, 5e-5, 1e-4, 5e-4, 1e-3, 3e-3})
        for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5})
          EXPECT_LT(offAt(60, from, deep, moves, Method::kShake, tolerance),
                    3 * tolerance * kSeconds)
              << from << " " << deep << " " << tolerance;
}

/// A rod over a capsule, both across the way. 4e-3 m off at 60 to 250 Hz, and within 1e-4 m/s 70
/// times what is allowed, where it is not seen.
TEST(Graze, OfARod) {
  Scene scene = parseScene(R"(
gravity: [0, 0, 0]
ragdolls:
  - {position: [-0.31, 0, 0.24999], velocity: [4, 0, 0],
     model: {sticks: [[p, q]], particles: {p: {position: [-0.02, -0.2, 0], mass: 1, radius: 0.05},
       q: {position: [0.02, 0.3, 0], mass: 1.2, radius: 0.05}}}}
obstacles: [{type: capsule, from: [0, -0.5, 0], to: [0, 0.5, 0], radius: 0.2, friction: 0}]
)");
  const Points end = endOfImpacts(scene, Method::kShake, 1.0 / 64000, kSeconds);
  for (const double rate : {120.0, 250.0, 1000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, kSeconds) - end), 1e-7);
  for (const double rate : {60.0, 120.0, 1000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kRk, 1 / rate, kSeconds) - end), 1e-9);
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    scene.solver.tolerance = tolerance;
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1.0 / 60, kSeconds) - end),
              3 * tolerance * kSeconds);
  }
}

}  // namespace
}  // namespace ragdoll::test
