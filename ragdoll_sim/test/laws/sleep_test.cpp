// A body at rest sleeps, costs nothing, and wakes when disturbed.
#include "ragdoll_sim/core/sleep.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/step/workspace.h"
#include "ragdoll_sim/core/measures.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

class Sleep : public testing::TestWithParam<Method> {
 protected:
  Scene resting() const {
    Scene scene = sceneOf(oneStick(1, 2, 0.1), Vec3(0, 0, 0.1));
    scene.obstacles = {floorPlane(0.5)};
    scene.solver.method = GetParam();
    scene.solver.step = 0.01;
    return scene;
  }
};

TEST_P(Sleep, FallsAsleepAfterTheQuietTimeAndHoldsStill) {
  World world(resting());
  world.steps(40);
  EXPECT_FALSE(world.state.asleep[0]);
  world.steps(20);
  ASSERT_TRUE(world.state.asleep[0]);
  EXPECT_TRUE(world.state.v.isZero(0));
  const Points x = world.state.x;
  world.steps(100);
  EXPECT_EQ(world.state.x, x);
}

TEST_P(Sleep, PokeWakesIt) {
  World world(resting());
  world.steps(100);
  ASSERT_TRUE(world.state.asleep[0]);
  Poke poke;
  poke.body = findBody(world.model, "ab");
  poke.start = world.state.time;
  poke.force = Vec3(0, 0, 300);
  world.inputs.pokes = {poke};
  world.steps(1);
  EXPECT_FALSE(world.state.asleep[0]);
  EXPECT_NEAR(momentum(world.model, world.state).z(), (300 - 3 * 9.81) * 0.01, 1e-9);
}

TEST_P(Sleep, ObstacleThatMovesNearWakesItAndAFarOneDoesNot) {
  Scene scene = resting();
  ObstacleSpec ball;
  ball.type = ObstacleSpec::Type::kSphere;
  ball.radius = 0.2;
  ball.pose.position = Vec3(5, 0, 0.2);
  scene.obstacles.push_back(ball);
  World world(scene);
  world.steps(100);
  ASSERT_TRUE(world.state.asleep[0]);
  world.inputs.obstacles = world.state.obstacles;
  world.inputs.obstacles[1].position.x() = 4;
  world.steps(1);
  EXPECT_TRUE(world.state.asleep[0]);
  world.inputs.obstacles[1].position.x() = 1.25;
  world.steps(1);
  EXPECT_FALSE(world.state.asleep[0]);
}

TEST_P(Sleep, APokeThatGoesOnKeepsItAwake) {
  Scene scene = resting();
  PokeSpec press;
  press.body = "ab";
  press.force = Vec3(0, 0, -1);
  press.duration = -1;
  scene.pokes = {press};
  World world(scene);
  for (int i = 0; i < 200; ++i) {
    world.steps(1);
    ASSERT_FALSE(world.state.asleep[0]);
  }
}

TEST_P(Sleep, CostsNothing) {
  World world(resting());
  world.steps(100);
  ASSERT_TRUE(world.state.asleep[0]);
  // What a step computes for a body is left in its workspace.
  Workspace fresh;
  const auto computed = [&] {
    const Workspace::Impl& ws = fresh.impl();
    const std::vector<std::vector<Body>>& places = ws.direct.scratch[0].island.places;
    const bool bound = !places.empty() && places[0][0].context;
    const bool moved = ws.relaxation.acceleration.cols() > 0 || bound;
    const bool sought =
        !ws.relaxation.contacts.empty() || (bound && !places[0][0].constraints.contacts.empty());
    return std::pair(moved, sought);
  };
  const StepReport asleep = step(world.model, world.inputs, fresh, world.state);
  EXPECT_EQ(computed(), std::pair(false, false));
  EXPECT_EQ(asleep.contacts, 0);
  wakeAll(world.state);
  const StepReport awake = step(world.model, world.inputs, fresh, world.state);
  EXPECT_EQ(computed(), std::pair(true, true));
  EXPECT_EQ(awake.contacts, 2);
}

TEST_P(Sleep, CanBeSwitchedOff) {
  Scene scene = resting();
  scene.solver.sleep = false;
  World world(scene);
  world.steps(200);
  EXPECT_FALSE(world.state.asleep[0]);
}

/// error: [m/s]
void expectWhatSlidesGoesOn(Method method, double error) {
  for (const double beyond : {-0.02, 0.02}) {  // [degrees] of the angle of friction
    Scene scene = sceneOf(oneStick(1, 1, 0.1));
    const double slope = std::atan(0.5) + beyond * M_PI / 180;
    scene.gravity = 9.81 * Vec3(std::sin(slope), 0, -std::cos(slope));
    scene.obstacles = {floorPlane(0.5)};
    scene.ragdolls[0].pose.position.z() = 0.1;
    scene.solver.method = method;
    scene.solver.step = 0.01;
    World world(scene);
    world.steps(400);
    EXPECT_EQ(world.state.asleep[0], beyond < 0);
    const double a = std::max(0.0, 9.81 * (std::sin(slope) - 0.5 * std::cos(slope)));
    EXPECT_NEAR(world.v(0).x(), 4 * a, error);
  }
}

TEST_P(Sleep, WhatSlidesAsAWholeGoesOnHoweverSlowly) { expectWhatSlidesGoesOn(GetParam(), 1e-6); }

/// It fell asleep up to 0.1 degrees beyond.
TEST(SleepByFast, WhatSlidesAsAWholeGoesOnHoweverSlowly) {
  expectWhatSlidesGoesOn(Method::kFast, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Methods, Sleep,
                         testing::Values(Method::kJakobsen, Method::kShake, Method::kRk));

}  // namespace
}  // namespace ragdoll
