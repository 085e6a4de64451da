// Impacts that come inside a step: what rubs where a limb digs in does so from the impact on, and
// what pressed before the impact keeps what it has given until then. Against closed forms, and `rk`
// from event to event.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/ends.h"
#include "support/gravity.h"
#include "support/worlds.h"

namespace ragdoll::test {
namespace {

/// A rod, two equal masses, turns and digs a tip into a floor so rough that friction presses it on.
/// The tip stops, the other end keeps its speed across the rod.
TEST(Impact, ARodThatDigsInStopsByItsTip) {
  const double start = std::acos(std::sqrt(2.0 / 3)), radius = 0.05, spin = 2;
  const Vec3 velocity(-2, 0, -1);
  Scene scene = sceneOf(oneStick(1, 1, radius));
  scene.gravity.setZero();
  scene.obstacles = {floorPlane(10)};
  scene.ragdolls[0].pose.orientation = Quat(Eigen::AngleAxisd(-start, Vec3::UnitY()));
  scene.ragdolls[0].velocity = velocity;
  scene.ragdolls[0].angular_velocity = Vec3(0, -spin, 0);
  scene.solver.method = Method::kShake;
  for (const double rate : {60.0, 120.0, 240.0, 1000.0})
    for (int i = 0; i < 20; ++i) {
      const double drop = 0.1 + 0.0007 * i;
      scene.ragdolls[0].pose.position = Vec3(0, 0, radius + drop);
      scene.solver.step = 1 / rate;
      World world(scene);
      world.steps(static_cast<int>(std::ceil(0.1 * rate)));
      double angle = start;
      for (int k = 0; k < 50; ++k)  // drop - t = (sin(angle) - sin(start))/2 at t = angle/spin
        angle = start + spin * (drop - 0.5 * (std::sin(angle) - std::sin(start)));
      const Vec3 across(-std::sin(angle), 0, std::cos(angle));
      const Vec3 other = (velocity.dot(across) + 0.5 * spin) * across;
      const Vec3 drift = 0.5 * (world.v(0) + world.v(1));
      ASSERT_LT((drift - 0.5 * other).norm(), 1e-4) << rate << ' ' << i;
    }
}

/// Two humans in the air, of which a foot meets a shin.
TEST(Impact, OfTwoHumansInTheAirIsTheSameAtAnyStep) {
  const Scene scene = parseScene(R"(
gravity: [0, 0, 0]
ragdoll_collision: true
ragdolls:
  - {name: a, model: human, position: [0, 0, 1], velocity: [4, 0, 0]}
  - {name: b, model: human, position: [2.2, 0.1, 1.2], rpy_deg: [20, 60, 40]}
)");
  const Points exact = endOfImpacts(scene, Method::kRk, 1e-3, 0.36);
  for (const double rate : {250.0, 500.0, 1000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.36) - exact),
              2.5 / (rate * rate))
        << rate;
}

/// A ball that lies on the floor is hit from below by a smaller one, and leaves it: gravity has had
/// no part in what the floor bore until then.
TEST(Impact, ThatLiftsABallTakesNothingBackFromTheFloor) {
  Scene scene = sceneOf(oneParticle(2, 0.1), Vec3(0, 0, 0.1));
  scene.ragdolls.push_back(sceneOf(oneParticle(3, 0.02), Vec3(-0.3, 0.01, 0.02)).ragdolls[0]);
  scene.ragdolls[1].name = "other";
  scene.ragdolls[1].velocity = Vec3(3, 0, 0);
  scene.gravity = Vec3(0, 0, -kG);
  scene.ragdoll_collision = true;
  scene.obstacles = {floorPlane()};
  const Points exact = endOfImpacts(scene, Method::kRk, 1e-3, 0.1);
  ASSERT_GT(exact(2, 0), 0.105) << "it was lifted";
  for (const double rate : {100.0, 200.0, 400.0, 1000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.1) - exact),
              0.1 / (rate * rate))
        << rate;
}

/// A ball is pushed along another one, rubbing, until that one meets a floor: until then nothing
/// outside holds the two, and they turn as one.
TEST(Impact, OfBallsThatRubOnEachOtherIsOfSecondOrder) {
  const Scene scene = parseScene(R"(
gravity: [0, 0, 0]
ragdoll_collision: true
pokes: [{body: b/p, force: [-2367.87285034375, 1290.26794744688, -3924.57412760668], at: 0, duration: 0.008}]
ragdolls:
  - {name: a, position: [0, 0, 0.053264101798118],
     model: {particles: {p: {position: [0, 0, 0], mass: 0.376555206223, radius: 0.05}}}}
  - {name: b, position: [0.0447157687784618, -0.023286229888723, 0.127817783934688],
     model: {particles: {p: {position: [0, 0, 0], mass: 1.60317051371, radius: 0.04}}}}
obstacles: [{type: plane, friction: 0}]
)");
  const Points exact = endOfImpacts(scene, Method::kRk, 1e-3, 0.012);
  for (const double rate : {1000.0, 2000.0, 4000.0, 8000.0, 16000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.012) - exact),
              1200 / (rate * rate))
        << rate;
}

/// Two balls, of which one is poked: about the line between them they have no inertia, and momentum
/// about it is no spin of theirs.
TEST(Impact, OfTwoBallsHasNoSpinAboutTheirLine) {
  const Scene scene = parseScene(R"(
gravity: [0, 0, 0]
ragdoll_collision: true
pokes: [{body: b/p0, force: [-5745.84760225, -423.196404578, -414.103744752], at: 0, duration: 0.004}]
ragdolls:
  - {name: a, model: {particles: {p0: {position: [0, 0.033995878604, -0.192813674971], mass: 0.189907798663, radius: 0.0293193903712}}}}
  - {name: b, model: {particles: {p0: {position: [0.0540078375124, -0.005179709563, -0.204172299486], mass: 1.8305362196, radius: 0.0371395871384}}}}
obstacles:
  - {type: sphere, position: [-0.33091704199, 0.0373341209219, -0.229452224216], radius: 0.293809822322, restitution: 0, friction: 0}
)");
  const Points exact = endOfImpacts(scene, Method::kRk, 1e-3, 0.048);
  for (const double rate : {1000.0, 2000.0, 4000.0, 8000.0, 16000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.048) - exact), 4 / rate)
        << rate;  // 0.13 at 2000 Hz with one of 1e9 rad/s
}

/// Balls on a floor that a smaller one, which flies above it, meets from below.
Scene flyUnder(const Vec3& velocity) {
  Scene scene = sceneOf(oneParticle(2, 0.1), Vec3(0, 0, 0.1));
  scene.ragdolls.push_back(sceneOf(oneParticle(3, 0.02), Vec3(-0.3, 0.01, 0.03)).ragdolls[0]);
  scene.ragdolls[1].name = "other";
  scene.ragdolls[1].velocity = velocity;
  scene.ragdoll_collision = true;
  scene.obstacles = {floorPlane(0.5)};
  return scene;
}

/// The floor lets go in the impact: nothing outside acts in it, and friction of two balls, which
/// have no spin, can take nothing from their motion past each other, though the floor has borne one
/// until then.
TEST(Impact, ThatLiftsABallLeavesTheMotionPastIt) {
  Scene scene = flyUnder(Vec3(3, 0, 0.4));
  scene.gravity = Vec3(0, 0, -kG);
  const Points exact = endOfImpacts(scene, Method::kRk, 1e-3, 0.14);
  ASSERT_GT(exact(2, 0), 0.12) << "it was lifted";
  for (const double rate : {100.0, 200.0, 400.0, 1000.0, 4000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.14) - exact),
              5 / (rate * rate))
        << rate;
}

/// An impact lifts the ball at `up`, and comes at `time`, both without gravity.
void findLift(const Scene& scene, double& time, double& up) {
  const RagdollSpec &ball = scene.ragdolls[0], &other = scene.ragdolls[1];
  const Vec3 way = ball.pose.position - other.pose.position, rate = -other.velocity;
  const double a = rate.squaredNorm(), b = way.dot(rate), c = way.squaredNorm() - 0.12 * 0.12;
  time = (-b - std::sqrt(b * b - a * c)) / a;
  const Vec3 normal = (way + time * rate).normalized();
  up = -normal.dot(rate) / (1 / 2.0 + 1 / 3.0) / 2 * normal.z();
}

/// A third ball comes down on it when it is `opened` off a floor that throws back.
double bounceOf(double opened, Method method, double h) {
  Scene scene = flyUnder(Vec3(3, 0, 0.4));
  scene.gravity.setZero();
  scene.obstacles[0].restitution = 0.5;
  double time = 0, up = 0;
  findLift(scene, time, up);
  const double later = opened / up, down = 2;
  const double height = 0.3 + down * (time + later) + up * later;
  scene.ragdolls.push_back(sceneOf(oneParticle(4, 0.1), Vec3(0, 0, height)).ragdolls[0]);
  scene.ragdolls[2].name = "third";
  scene.ragdolls[2].velocity = Vec3(0, 0, -down);
  return endOfImpacts(scene, method, h, 0.12)(2, 0);
}

/// What an impact has opened by less than the smallest steps tell is still in the next one, and
/// does not bounce; what is farther comes back by itself. The methods agree which.
TEST(Impact, ThatFollowsAnotherAtOnceMeetsTheSameInBothMethods) {
  for (const double opened : {4e-9, 1e-7}) {
    const double exact = bounceOf(opened, Method::kRk, 1e-3);
    EXPECT_NEAR(bounceOf(opened, Method::kShake, 1.0 / 16000), exact, 1e-5) << opened;
  }
}

/// A ball slides down a sphere until another hits it: where it presses has turned by then.
TEST(Impact, OnABallThatSlidesDownASphereIsOfSecondOrder) {
  Scene scene = sceneOf(oneParticle(2, 0.05), Vec3(0.1, 0, std::sqrt(0.25 * 0.25 - 0.1 * 0.1)));
  scene.ragdolls[0].velocity = Vec3(0.5, 0, -0.5 * 0.1 / scene.ragdolls[0].pose.position.z());
  scene.ragdolls.push_back(sceneOf(oneParticle(1, 0.05), Vec3(0.62, 0.02, 0.3)).ragdolls[0]);
  scene.ragdolls[1].name = "other";
  scene.ragdolls[1].velocity = Vec3(-3, 0, -0.5);
  scene.gravity = Vec3(0, 0, -kG);
  scene.ragdoll_collision = true;
  ObstacleSpec sphere;
  sphere.type = ObstacleSpec::Type::kSphere;
  sphere.radius = 0.2;
  scene.obstacles = {sphere};
  const Points exact = endOfImpacts(scene, Method::kRk, 1e-3, 0.2);
  for (const double rate : {100.0, 200.0, 400.0, 1000.0, 2000.0, 4000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.2) - exact),
              0.5 / (rate * rate))
        << rate;
}

/// A rod lands on a bar by its end and turns down onto it, so that the place where they touch runs
/// along the rod from that end: nothing jumps there.
TEST(Impact, ThatPassesFromTheEndOfARodOntoIt) {
  Scene scene = sceneOf(oneStick(1, 2, 0.05), Vec3(0, 0, 0.35));
  scene.ragdolls[0].pose.orientation = Quat(Eigen::AngleAxisd(-0.1, Vec3::UnitY()));
  scene.ragdolls[0].velocity = Vec3(0, 0, -0.5);
  scene.gravity = Vec3(0, 0, -kG);
  ObstacleSpec bar;
  bar.type = ObstacleSpec::Type::kCapsule;
  bar.radius = 0.1;
  bar.from = Vec3(-1, -0.2, 0.15);
  bar.to = Vec3(1, 0.25, 0.15);
  scene.obstacles = {bar};
  const Points exact = endOfImpacts(scene, Method::kRk, 1e-3, 0.25);
  for (const double rate : {500.0, 1000.0, 4000.0, 16000.0})
    EXPECT_LT(largest(endOfImpacts(scene, Method::kShake, 1 / rate, 0.25) - exact),
              std::max(7 / (rate * rate), 2e-7))
        << rate;
}

}  // namespace
}  // namespace ragdoll::test
