// Damping of inner motion: momentum and angular momentum stay, swinging decays at the stated rate.
#include "core/mechanics/joint_damping.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/limit_of.h"
#include "support/mass_matrix.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

TEST(JointDamping, LeavesMomentumAndSpinAndEndsRigid) {
  Scene scene = parseScene(
      "gravity: [0, 0, 0]\n"
      "ragdolls: [{name: ragdoll, model: human, velocity: [1, 0, 0], angular_velocity: [1, 2, "
      "3]}]\n"
      "pokes: [{at: 0, body: right_hand, force: [100, 0, 50], duration: 0.1}]\n"
      "solver: {joint_damping: 4}\n",
      "test");
  World world(scene);
  world.steps(13);
  const Vec3 p = momentum(world.model, world.state), l = angularMomentum(world.model, world.state);
  world.steps(1200);
  EXPECT_LT((momentum(world.model, world.state) - p).norm(), 1e-9);
  // To first order in the step where joint limits press: they push along the end of a step.
  EXPECT_LT((angularMomentum(world.model, world.state) - l).norm() / l.norm(), 1e-2);
  // Rigid: distances between all particles stay.
  const double before = (world.x(0) - world.x(9)).norm();
  world.steps(60);
  EXPECT_NEAR((world.x(0) - world.x(9)).norm(), before, 1e-3);
}

TEST(JointDamping, InnerVelocityDecaysAtTheRate) {
  Points x(3, 3), v = Points::Zero(3, 3);
  x << -1, 0, 1, 0, 0, 0, 0, 0, 0;
  v.row(1) << 1, -2, 1;  // bends: no momentum, no spin
  const Points start = v;
  LooseMasses masses(Eigen::MatrixXd::Identity(3, 3));
  dampInnerMotion(masses.matrix(), {}, std::exp(-0.3), x, v);
  EXPECT_LT((v - std::exp(-0.3) * start).norm(), 1e-12);
  v.row(1) << -1, 0, 1;  // turns about the middle: nothing to damp
  const Points turning = v;
  dampInnerMotion(masses.matrix(), {}, 0.5, x, v);
  EXPECT_LT((v - turning).norm(), 1e-8);
  dampInnerMotion(masses.matrix(), {1}, 0.5, x, v);  // pinned in the middle: the same turn
  EXPECT_LT((v - turning).norm(), 1e-8);
}

/// A chain on the floor of the Moon whose free end falls and hits: damping takes what lies on towards
/// it, at a speed that is no impact. Taken for one, again and again, it left no room for that of the
/// end: 1e-4 m off at any step.
TEST(JointDamping, IsNoImpactOfWhatLies) {
  const LimitOf chain(R"(
gravity: [0, 0, -1.62]
ragdolls:
  - position: [0, 0, 0.05]
    velocity: [0, 0, -3]
    angular_velocity: [0, 5, 0]
    model:
      particles:
        a: {position: [0, 0, 0], mass: 1, radius: 0.05}
        b: {position: [0.4, 0, 0], mass: 1, radius: 0.05}
        c: {position: [0.7, 0, 0.25], mass: 1, radius: 0.05}
      sticks: [[a, b], [b, c]]
obstacles: [{type: plane, friction: 0.3}]
solver: {joint_damping: 40}
)",
                      0.2);
  chain.expectSecondOrder(40, {250, 1000, 2000, 4000, 8000});
}

}  // namespace
}  // namespace ragdoll
