// Forces that follow the motion: damping, pokes off their body's point, friction in a bounce.
#include <gtest/gtest.h>

#include <cmath>

#include "core/mechanics/joint_damping.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/ends.h"
#include "support/mass_matrix.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// The human's sticks and masses alone: nothing ends what is smooth.
Scene limp(const std::string& text) {
  Scene scene = parseScene(text);
  removeJoints(scene);
  return scene;
}

/// The order at which positions converge on those of `best`.
double orderTowards(const Scene& scene, Method method, double rate, double seconds,
                    const Points& best) {
  const double coarse = (endOf(scene, method, rate, seconds) - best).norm();
  const double fine = (endOf(scene, method, 2 * rate, seconds) - best).norm();
  return std::log2(coarse / fine);
}

/// After 0.2 s, against rk at 1920 steps a second.
void expectOrders(const Scene& scene) {
  const Points best = endOf(scene, Method::kRk, 1920, 0.2);
  EXPECT_GT(orderTowards(scene, Method::kShake, 240, 0.2, best), 1.8);
  EXPECT_GT(orderTowards(scene, Method::kRk, 60, 0.2, best), 4.5);
}

TEST(Damping, OfABallIsOfSecondOrderInShakeAndExactInRk) {
  Scene scene = sceneOf(oneParticle());
  scene.gravity.setZero();
  scene.ragdolls[0].velocity = Vec3(1, 0, 0);
  scene.solver.damping = 2;
  const double way = (1 - std::exp(-2.0)) / 2;
  EXPECT_NEAR(endOf(scene, Method::kShake, 60, 1)(0, 0), way, 1e-4 * way);
  EXPECT_NEAR(endOf(scene, Method::kShake, 120, 1)(0, 0), way, 2.5e-5 * way);
  EXPECT_NEAR(endOf(scene, Method::kRk, 60, 1)(0, 0), way, 1e-9 * way);
}

TEST(Damping, OfWhatSlidesIsOfSecondOrder) {
  Scene scene = sceneOf(oneParticle(1, 0.1), Vec3(0, 0, 0.1));
  scene.gravity = Vec3(0, 0, -10);
  scene.obstacles = {floorPlane(0.3)};
  scene.ragdolls[0].velocity = Vec3(4, 0, 0);
  scene.solver.damping = 2;  // v' = -2 v - 3: v = 5.5 exp(-2 t) - 1.5
  const double way = 5.5 * (1 - std::exp(-1.0)) / 2 - 0.75;
  for (const Method method : {Method::kShake, Method::kRk}) {
    EXPECT_NEAR(endOf(scene, method, 60, 0.5)(0, 0), way, 2e-4);
    EXPECT_NEAR(endOf(scene, method, 240, 0.5)(0, 0), way, 1.25e-5);
  }
}

TEST(Damping, OfJointsKeepsTheOrderOfTheMethod) {
  expectOrders(
      limp("gravity: [0, 0, 0]\n"
           "ragdolls: [{model: human_lumped, angular_velocity: [1, 2, 0.5]}]\n"
           "solver: {joint_damping: 2, damping: 0.5}\n"));
}

TEST(Damping, OfJointsLeavesASwingAboutTwoPins) {
  Points x(3, 3), v = Points::Zero(3, 3);
  x << 0, 1, 0.3, 0, 0, 0, 0, 0, -1;
  v(1, 2) = 2;  // turns about the line through the first two
  const Points swing = v;
  LooseMasses masses(Eigen::MatrixXd::Identity(3, 3));
  dampInnerMotion(masses.matrix(), {0, 1}, 0.5, x, v);
  EXPECT_LT((v - swing).norm(), 1e-8);
  dampInnerMotion(masses.matrix(), {0, 1, 2}, 0.5, x, v);
  EXPECT_NEAR(v(1, 2), 1, 1e-8);
}

TEST(Damping, OfJointsLeavesTheSwingOfAPlateOnTwoPins) {
  SkeletonSpec plate = oneStick();
  plate.particles.push_back(particle("c", Vec3(0.3, 0, -1)));
  plate.sticks.push_back(stick("b", "c"));
  plate.sticks.push_back(stick("a", "c"));
  Scene scene = sceneOf(plate);
  scene.gravity.setZero();
  scene.ragdolls[0].angular_velocity = Vec3(2, 0, 0);
  scene.solver.joint_damping = 5;
  for (const char* end : {"ragdoll/a", "ragdoll/b"}) scene.pins.push_back({end, "", "pins"});
  for (const Method method : {Method::kShake, Method::kRk}) {
    scene.solver.method = method;
    World world(scene);
    const double speed = world.v(2).norm();
    world.steps(120);
    EXPECT_NEAR(world.v(2).norm(), speed, 1e-6 * speed);
  }
}

TEST(PokeWithPoint, KeepsTheOrderOfTheMethod) {
  expectOrders(
      limp("gravity: [0, 0, 0]\n"
           "ragdolls: [{model: human_lumped}]\n"
           "pokes: [{at: 0, body: torso, force: [100, 50, -80], point: [0.2, 0.1, 0.3], duration: "
           "1}]\n"));
}

TEST(Bounce, OfJakobsenHasTheFrictionOfTheWholeImpact) {
  for (const double rate : {60.0, 240.0, 1000.0})
    for (int phase = 0; phase < 10; ++phase) {
      Scene scene = sceneOf(oneParticle(1, 0.1), Vec3(0, 0, 0.5 + 0.3 * phase / rate));
      scene.gravity.setZero();
      scene.obstacles = {floorPlane(0.2, 0.5)};
      scene.ragdolls[0].velocity = Vec3(3, 0, -3);
      scene.solver.method = Method::kJakobsen;
      scene.solver.step = 1 / rate;
      World world(scene);
      world.steps(static_cast<int>(0.3 * rate));
      EXPECT_NEAR(world.v(0).z(), 1.5, 1e-9);
      EXPECT_NEAR(world.v(0).x(), 3 - 0.2 * 1.5 * 3, 1e-9) << rate << " " << phase;
    }
}

}  // namespace
}  // namespace ragdoll
