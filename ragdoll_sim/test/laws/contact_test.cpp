// Contact laws: Coulomb's stopping distance in every direction, Newton's bounce, no way through.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/gravity.h"
#include "support/limbs.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

class Sliding : public testing::TestWithParam<double> {};

TEST_P(Sliding, StopsAfterVSquaredOverTwoMuGStraightOn) {
  constexpr double kSpeed = 2, kMu = 0.5, kStep = 2e-4;
  const Vec3 direction(std::cos(rad(GetParam())), std::sin(rad(GetParam())), 0);
  Scene scene = sceneOf(oneParticle(3, 0.1), Vec3(0, 0, 0.1));
  scene.ragdolls[0].velocity = kSpeed * direction;
  scene.obstacles = {floorPlane(kMu)};
  scene.solver.step = kStep;
  World world(scene);
  world.steps(static_cast<int>(1 / kStep));
  // First order: the sum over steps differs from the integral by half a step of motion.
  EXPECT_NEAR(world.x(0).head<2>().norm(), kSpeed * kSpeed / (2 * kMu * kG), kSpeed * kStep);
  EXPECT_LT(std::abs(world.x(0).cross(direction).z()), 1e-10);
  EXPECT_LT(world.v(0).norm(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Directions, Sliding, testing::Values(0.0, 31.0, 45.0));

TEST(Slope, HoldsBelowTheFrictionAngleAndSlidesAboveIt) {
  constexpr double kStep = 1e-3, kAngle = 30;
  for (const double mu : {0.6, 0.5}) {  // tan 30 deg = 0.577
    Scene scene = sceneOf(oneParticle(), Vec3::Zero());
    ObstacleSpec plane = floorPlane(mu);
    plane.normal = Vec3(std::sin(rad(kAngle)), 0, std::cos(rad(kAngle)));
    scene.obstacles = {plane};
    scene.solver.step = kStep;
    World world(scene);
    world.steps(1000);
    const double a = kG * (std::sin(rad(kAngle)) - mu * std::cos(rad(kAngle)));
    const double expected = a > 0 ? 0.5 * a : 0;
    EXPECT_NEAR(world.x(0).norm(), expected, 2 * kStep) << "mu " << mu;
  }
}

/// A rod that is held by its end and lies on `what`. A poke presses it on and pushes it aside, by
/// less than friction holds.
Scene pokedRodOn(const std::string& what) {
  return parseScene(
      "ragdolls:\n"
      "  - name: rod\n"
      "    position: [0, 0, 0.05]\n"
      "    model:\n"
      "      particles:\n"
      "        a: {position: [0, 0, 0], radius: 0.05}\n"
      "        b: {position: [0.8, 0, 0], radius: 0.05}\n"
      "      sticks: [[a, b]]\n"
      "      segments: {rod: {from: a, to: b, mass: 3, com: 0.4, gyration: 0.3}}\n"
      "pins: [a]\n"
      "obstacles: [" +
      what +
      "]\n"
      "pokes: [{body: b, force: [0, 80, -600], at: 0.02, duration: 0.05}]\n"
      "solver: {method: shake, sleep: false}\n");
}

/// No impulse moves the rod along itself, which is one of friction's two directions here: the other
/// holds it nevertheless, from the poke's first step on.
TEST(Poke, DoesNotMoveWhatFrictionHolds) {
  const std::string rough = ", name: o, friction: 0.4}";
  for (const std::string& what :
       {"{type: plane" + rough, "{type: sphere, position: [0.5, 0, -0.2], radius: 0.2" + rough}) {
    Scene scene = pokedRodOn(what);
    for (const double rate : {250.0, 1000.0, 4000.0}) {
      scene.solver.step = 1 / rate;
      World world(scene);
      const Points start = world.state.x;
      for (int i = 0; i < 0.1 * rate; ++i) {
        world.steps(1);
        const Points moved = world.state.x - start;
        ASSERT_LT(moved.topRows(2).norm(), 1e-6) << what << " at " << rate << " Hz";
        ASSERT_LT(moved.norm(), 2e-5) << what << " at " << rate << " Hz";  // deep, of fourth order
      }
    }
  }
}

class Bounce : public testing::TestWithParam<double> {};

TEST_P(Bounce, RisesToRestitutionSquaredTimesTheHeight) {
  constexpr double kHeight = 1, kRadius = 0.05, kStep = 1e-3;
  const double e = GetParam();
  Scene scene = sceneOf(oneParticle(1, kRadius), Vec3(0, 0, kHeight + kRadius));
  scene.obstacles = {floorPlane(0, e)};
  scene.solver.step = kStep;
  scene.solver.integrator = Integrator::kMidpoint;
  World world(scene);
  const double fall = std::sqrt(2 * kHeight / kG);
  world.steps(static_cast<int>(std::ceil(fall / kStep)) + 2);
  double top = 0;
  for (int i = 0; i < static_cast<int>(e * fall / kStep) + 5; ++i) {
    world.steps(1);
    top = std::max(top, world.x(0).z() - kRadius);
  }
  EXPECT_NEAR(top, e * e * kHeight, 2e-3 * kHeight);
}

INSTANTIATE_TEST_SUITE_P(Restitutions, Bounce, testing::Values(0.3, 0.5, 0.8, 1.0));

/// A thin box, 0.2 m, met at any speed from above.
class Bullet : public testing::TestWithParam<double> {};

TEST_P(Bullet, ParticleDoesNotPassAThinBox) {
  Scene scene = sceneOf(oneParticle(1, 0.02), Vec3(0.1, 0.1, 3));
  scene.ragdolls[0].velocity = Vec3(0.1, 0, -GetParam());
  ObstacleSpec box;
  box.type = ObstacleSpec::Type::kBox;
  box.size = Vec3(4, 4, 0.2);
  scene.obstacles = {box};
  World world(scene);
  world.steps(60);
  EXPECT_NEAR(world.x(0).z(), 0.12, 1e-6);
}

TEST_P(Bullet, StickIsCaughtBetweenItsEnds) {
  // The beam's middle meets a thin wall edge-on; both ends miss it.
  Scene scene = sceneOf(oneStick(1, 1, 0.02), Vec3(-0.5, 0, 3));
  scene.ragdolls[0].velocity = Vec3(0, 0, -GetParam());
  scene.gravity.setZero();
  scene.solver.sweeps = 100;  // two contacts near each other converge slowly
  ObstacleSpec box;
  box.type = ObstacleSpec::Type::kBox;
  box.size = Vec3(0.2, 4, 0.2);
  scene.obstacles = {box};
  World world(scene);
  world.steps(120);
  const double middle = 0.5 * (world.x(0).z() + world.x(1).z());
  EXPECT_GT(middle, 0.12 - 1e-6);
  EXPECT_LT(middle, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Speeds, Bullet, testing::Values(3.0, 30.0, 1000.0));

/// What starts in the middle of an obstacle comes out, however symmetric it lies.
class Within : public testing::TestWithParam<std::tuple<ObstacleSpec::Type, Method>> {
 protected:
  static bool isFast() { return std::get<1>(GetParam()) == Method::kFast; }
  static Scene inside(SkeletonSpec skeleton, const Vec3& at) {
    Scene scene = sceneOf(std::move(skeleton), at);
    scene.gravity.setZero();
    ObstacleSpec o;
    o.type = std::get<0>(GetParam());
    scene.solver.method = std::get<1>(GetParam());
    o.radius = 0.3;
    o.size = Vec3(0.6, 0.6, 2);
    o.from = Vec3(0, 0, -1);
    o.to = Vec3(0, 0, 1);
    scene.obstacles = {o};
    return scene;
  }
};

TEST_P(Within, ABallComesOut) {
  World world(inside(oneParticle(1, 0.05), Vec3::Zero()));
  EXPECT_GT(maxPenetration(world.model, world.state), 0.3);
  world.steps(120);
  EXPECT_LT(maxPenetration(world.model, world.state), isFast() ? 6e-3 : 1e-3);
}

TEST_P(Within, AStickComesOut) {
  World world(inside(oneStick(1, 1, 0.05), Vec3(-0.5, 0, 0)));
  world.steps(240);
  EXPECT_LT(maxStickPenetration(world.model, world.state), isFast() ? 2e-2 : 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Within,
                         testing::Combine(testing::Values(ObstacleSpec::Type::kSphere,
                                                          ObstacleSpec::Type::kBox,
                                                          ObstacleSpec::Type::kCapsule),
                                          testing::Values(Method::kShake, Method::kFast)));

/// The bound of energy held a body that could not be lifted out of a floor as it was, upright.
TEST(SunkByFast, AHumanFallsOver) {
  for (const double rate : {60, 240})
    for (const double deep : {0.0005, 0.005}) {
      Scene scene = parseScene(
          "ragdolls: [{model: human, position: [0, 0, 2], rpy_deg: [0, 3, 0]}]\n"
          "obstacles: [{type: plane, friction: 0.5}]\n");
      scene.solver.method = Method::kFast;
      scene.solver.step = 1 / rate;
      double lowest = 1;
      {
        const World above(scene);
        for (int i = 0; i < above.state.x.cols(); ++i)
          lowest = std::min(lowest, above.state.x(2, i) - above.model.radius[i]);
      }
      scene.ragdolls[0].pose.position.z() -= lowest + deep;
      World world(scene);
      world.steps(static_cast<int>(3 * rate));
      EXPECT_LT(world.state.x.row(2).maxCoeff(), 0.5) << rate << " " << deep;
    }
}

/// Bodies that start in each other part as far as packs let them be.
TEST(SunkByFast, BallsPart) {
  Scene scene = parseScene(R"(
gravity: [0, 0, 0]
ragdoll_collision: true
ragdolls:
  - {name: a, model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.05}}}}
  - name: b
    position: [0.04, 0, 0.01]
    model: {particles: {p: {position: [0, 0, 0], mass: 1, radius: 0.05}}}
)");
  scene.solver.method = Method::kFast;
  World world(scene);
  world.steps(60);
  EXPECT_GT((world.x(0) - world.x(1)).norm(), 0.08);
}

TEST(Obstacles, MovingFloorLiftsAndCarries) {
  Scene scene = sceneOf(oneParticle(1, 0.1), Vec3(0, 0, 0.6));
  ObstacleSpec box;
  box.type = ObstacleSpec::Type::kBox;
  box.size = Vec3(10, 10, 1);
  box.friction = 1;
  scene.obstacles = {box};
  World world(scene);
  world.steps(30);
  for (int i = 1; i <= 60; ++i) {  // 0.3 m/s forward and 0.6 m/s up for one second
    world.inputs.obstacles = {{Vec3(0.005 * i, 0, 0.01 * i), Quat::Identity()}};
    world.steps(1);
  }
  EXPECT_NEAR(world.x(0).z(), 1.2, 1e-6);
  EXPECT_NEAR(world.x(0).x(), 0.3, 0.01);
}

}  // namespace
}  // namespace ragdoll
