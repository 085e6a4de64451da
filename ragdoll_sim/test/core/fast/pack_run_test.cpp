#include "core/fast/pack_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/fast/constants.h"
#include "core/step/workspace.h"
#include "ragdoll_sim/core/measures.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// A heavy ball between two light ones, rigid, falls flat: one end is stopped, and the other one
/// goes twice as far as in free fall, into what nobody has looked at. A fourth of the step leaves
/// nothing that it would have to be made again for.
Scene seeSaw() {
  SkeletonSpec see_saw = oneParticle();
  see_saw.particles = {particle("left", {-0.5, 0, 0}, 0.1, 0.05),
                       particle("heavy", {0, 0, 0.2}, 10, 0.05),
                       particle("right", {0.5, 0, 0}, 0.1, 0.05)};
  see_saw.sticks = {stick("left", "heavy"), stick("heavy", "right"), stick("left", "right")};
  Scene scene = sceneOf(see_saw, Vec3(0, 0, 2));
  scene.solver.method = Method::kFast;
  scene.solver.step = 1.0 / 60;
  scene.ragdolls[0].velocity = Vec3(0, 0, -10);
  for (const double x : {-0.5, 0.6}) {
    ObstacleSpec box;
    box.type = ObstacleSpec::Type::kBox;
    box.size = x < 0 ? Vec3(0.2, 0.2, 1) : Vec3(0.4, 0.4, 1);
    box.pose.position = x < 0 ? Vec3(x, 0, 1.4) : Vec3(x, 0, 1.05);
    scene.obstacles.push_back(box);
  }
  return scene;
}

TEST(Parts, KeepOutWhatAnotherEndIsThrownInto) {
  Scene scene = seeSaw();
  scene.solver.step = 1.0 / 240;
  scene.obstacles[0].pose.position.z() = 1.43;
  scene.obstacles[1].pose.position.z() = 1.35;
  World world(scene);
  EXPECT_EQ(world.steps(1).fast_fallbacks, 0);
  EXPECT_LT(maxPenetration(world.model, world.state), 5e-3);
}

/// What turns by 1.5 rad in a step, held by a pin.
Scene whirl() {
  Scene scene = seeSaw();
  scene.obstacles.clear();
  scene.pins = {pinOf("heavy")};
  scene.ragdolls[0].velocity = Vec3::Zero();
  scene.ragdolls[0].angular_velocity = Vec3(0, 90, 0);
  return scene;
}

TEST(Parts, AreStepsOfTheirOwn) {
  Scene scene = whirl();
  World whole(scene);
  EXPECT_EQ(whole.steps(1).fast_fallbacks, 0);
  scene.solver.step /= fast::kParts;
  World parts(scene);
  parts.steps(fast::kParts);
  EXPECT_EQ(whole.state.x, parts.state.x);
  EXPECT_EQ(whole.state.v, parts.state.v);
}

/// A ball that a floor throws back is hit when it gets there, to a tenth of a short part.
TEST(Parts, EndWhereSomethingIsHit) {
  Scene scene = sceneOf(oneParticle(1, 0.05), Vec3(0, 0, 0.25));
  scene.gravity.setZero();
  scene.obstacles = {floorPlane(0, 1)};
  scene.ragdolls[0].velocity = Vec3(1, 0, -5);
  scene.solver.method = Method::kFast;
  for (const double rate : {21.0, 22.0, 60.0}) {
    scene.solver.step = 1 / rate;
    World world(scene);
    world.steps(static_cast<int>(0.1 * rate));
    const double time = std::floor(0.1 * rate) / rate;
    const double late = 0.1 * fast::kImpactShare / rate;
    EXPECT_NEAR(world.x(0).z(), 0.05 + std::abs(5 * time - 0.2), 1.01 * 5 * late) << rate;
    EXPECT_NEAR(world.x(0).x(), time, 1e-12);
    EXPECT_NEAR(world.v(0).z(), 5, 1e-9);
  }
}

/// Which is led on by as much in each part.
TEST(Parts, LeadAPin) {
  const Scene scene = whirl();
  World world(scene);
  const Vec3 way(0.004, 0, 0.002);  // [m] in a step
  const Vec3 target = world.x(1) + way;
  world.inputs.pins = {target};
  EXPECT_EQ(world.steps(1).fast_fallbacks, 0);
  EXPECT_LT((world.x(1) - target).norm(), 1e-12);
  EXPECT_LT((world.state.v.col(1) - 60 * way).norm(), 1e-9);
}

TEST(Parts, AreNotBesideWhatMoves) {
  Scene scene = seeSaw();
  scene.ragdolls[0].angular_velocity = Vec3(0, 90, 0);
  World world(scene);
  world.inputs.obstacles = {scene.obstacles[0].pose, scene.obstacles[1].pose};
  world.inputs.obstacles[1].position.x() += 0.01;
  EXPECT_EQ(world.steps(1).fast_fallbacks, 1);
}

}  // namespace
}  // namespace ragdoll
