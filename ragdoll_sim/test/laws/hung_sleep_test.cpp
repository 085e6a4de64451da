// What hangs or floats sleeps only when it really is at rest: no swing ends at its turning point.
#include <gtest/gtest.h>

#include <cmath>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/sleep.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

class HungSleep : public testing::TestWithParam<Method> {
 protected:
  /// A stick of 1 m that hangs `aside` [m] from a pin: a pendulum, its mass at its end.
  Scene pendulum(double aside) const {
    SkeletonSpec stick = oneStick();
    stick.particles[1].position = Vec3(aside, 0, -std::sqrt(1 - aside * aside));
    Scene scene = sceneOf(stick, Vec3(0, 0, 3));
    scene.pins = {pinOf("a")};
    scene.solver.method = GetParam();
    scene.solver.step = 0.01;
    return scene;
  }

  Scene hangingStill() const { return pendulum(0); }

  static bool everAsleep(World& world, int steps) {
    for (int i = 0; i < steps && !world.state.asleep[0]; ++i) world.steps(1);
    return world.state.asleep[0];
  }
};

TEST_P(HungSleep, WhatHangsStillFallsAsleep) {
  World world(hangingStill());
  const Points x = world.state.x;
  world.steps(195);
  EXPECT_FALSE(world.state.asleep[0]);
  world.steps(10);
  EXPECT_TRUE(world.state.asleep[0]);
  world.steps(100);
  EXPECT_LT((world.state.x - x).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_P(HungSleep, ASwingThatDampingEndsComesToRestWhereItHangsStill) {
  Scene scene = pendulum(0.5);
  scene.solver.damping = 2;
  World world(scene);
  EXPECT_TRUE(everAsleep(world, 2000));
  EXPECT_NEAR(world.x(1).x(), 0, 1e-4);
  EXPECT_NEAR(world.x(1).z(), 2, 1e-6);
}

TEST_P(HungSleep, ASmallSwingGoesOn) {
  World world(pendulum(1e-3));  // at most 3 mm/s
  EXPECT_FALSE(everAsleep(world, 1000));
}

TEST_P(HungSleep, ASlowSwingGoesOnAtItsTurningPoint) {
  // Of a period of 63 s, at most 2 mm/s; it is slower than kHungSpeed for 0.5 s around its start.
  Scene scene = pendulum(0.02);
  scene.gravity = Vec3(0, 0, -0.01);
  World world(scene);
  double least = 1;
  for (int i = 0; i < 6300; ++i) {
    world.steps(1);
    ASSERT_FALSE(world.state.asleep[0]) << "at " << world.state.time << " s";
    least = std::min(least, world.x(1).x());
  }
  EXPECT_LT(least, -0.0195);
}

TEST_P(HungSleep, AWallThatItTouchesAtItsTurningPointDoesNotEndASwing) {
  // Gravity presses it to the wall all the time; a period is 2 pi / sqrt(0.1) = 19.9 s.
  Scene scene = pendulum(0.1);
  scene.gravity = Vec3(0, 0.02, -0.1);
  ObstacleSpec wall = floorPlane();
  wall.pose.position = Vec3(0, 0.05, 0);
  wall.normal = -Vec3::UnitY();
  scene.obstacles = {wall};
  SkeletonSpec stick = *scene.ragdolls[0].skeleton;
  for (ParticleSpec& p : stick.particles) p.radius = 0.05;
  scene.ragdolls[0].skeleton = std::make_shared<const SkeletonSpec>(stick);
  World world(scene);
  int contacts = 0;
  double least = 1;
  for (int i = 0; i < 2000; ++i) {
    contacts += world.steps(1).contacts;
    ASSERT_FALSE(world.state.asleep[0]) << "at " << world.state.time << " s";
    least = std::min(least, world.x(1).x());
  }
  EXPECT_GT(contacts, 1000);
  EXPECT_LT(least, -0.098);
}

TEST_P(HungSleep, APokeWakesIt) {
  World world(hangingStill());
  ASSERT_TRUE(everAsleep(world, 300));
  Poke poke;
  poke.body = findBody(world.model, "b");
  poke.start = world.state.time;
  poke.force = Vec3(1, 0, 0);
  world.inputs.pokes = {poke};
  world.steps(1);
  EXPECT_FALSE(world.state.asleep[0]);
  EXPECT_NEAR(world.v(1).x(), 0.01, 1e-5);
}

TEST_P(HungSleep, APinThatMovesWakesItAndOneThatStaysDoesNot) {
  World world(hangingStill());
  ASSERT_TRUE(everAsleep(world, 300));
  world.inputs.pins = {world.model.pins[0].target};
  world.steps(100);
  EXPECT_TRUE(world.state.asleep[0]);
  world.inputs.pins[0].x() += 1e-6;
  world.steps(1);
  EXPECT_FALSE(world.state.asleep[0]);
}

TEST_P(HungSleep, AnObstacleThatMovesNearWakesIt) {
  Scene scene = hangingStill();
  ObstacleSpec ball;
  ball.type = ObstacleSpec::Type::kSphere;
  ball.radius = 0.2;
  ball.pose.position = Vec3(2, 0, 2);
  scene.obstacles = {ball};
  World world(scene);
  ASSERT_TRUE(everAsleep(world, 300));
  world.inputs.obstacles = world.state.obstacles;
  world.inputs.obstacles[0].position.x() = 0.24;
  world.steps(1);
  EXPECT_FALSE(world.state.asleep[0]);
}

TEST_P(HungSleep, WhatFloatsStillSleepsAndWhatDriftsDoesNot) {
  for (const double drift : {0.0, 1e-6, 1e-3}) {
    Scene scene = hangingStill();
    scene.pins.clear();
    scene.gravity.setZero();
    scene.ragdolls[0].velocity = Vec3(drift, 0, 0);
    World world(scene);
    EXPECT_EQ(everAsleep(world, 300), drift == 0) << drift;
    if (drift == 0) continue;
    EXPECT_NEAR(world.x(0).x(), 3 * drift, 1e-12);
  }
}

TEST_P(HungSleep, WhatIsThrownUpDoesNotSleepAtItsHighestPoint) {
  Scene scene = hangingStill();
  scene.pins.clear();
  scene.gravity = Vec3(0, 0, -1e-4);
  scene.ragdolls[0].velocity = Vec3(0, 0, 1e-3);
  World world(scene);
  EXPECT_FALSE(everAsleep(world, 2000));
  EXPECT_NEAR(world.v(0).z(), -1e-3, 1e-9);
}

TEST_P(HungSleep, AHumanThatHangsUprightComesToRest) {
  for (const char* part : {"hand", "shoulder"}) {
    Scene scene = loadScene("hang");
    scene.pins.clear();
    for (const char* side : {"left_", "right_"}) {
      scene.pins.push_back(pinOf(std::string("ragdoll/") + side + part));
    }
    scene.ragdolls[0].pose.orientation = Quat::Identity();
    scene.solver.method = GetParam();
    scene.solver.damping = scene.solver.joint_damping = 2;
    World world(scene);
    for (const Pin& pin : world.model.pins) world.inputs.pins.push_back(pin.target);
    EXPECT_TRUE(everAsleep(world, 20 * 120)) << part;
    RecordProperty(part, std::to_string(world.state.time) + " s");
    world.steps(100);
    EXPECT_TRUE(world.state.asleep[0]) << part << ": pins that do not move";
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, HungSleep,
                         testing::Values(Method::kJakobsen, Method::kShake, Method::kRk));

}  // namespace
}  // namespace ragdoll
