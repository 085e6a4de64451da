#include "core/relaxation/relaxation_guard.h"

#include <gtest/gtest.h>

#include "ragdoll_sim/core/measures.h"
#include "support/direct_island.h"

namespace ragdoll {
namespace {

using namespace test;

/// A chain whose last particle weighs a million times the others flies off at its end, which one
/// sweep over its sticks cannot follow.
Scene whipped(double mass, double speed) {
  SkeletonSpec chain = chainOfThree();
  chain.particles[2].mass = mass;
  Scene scene = weightless(chain);
  scene.solver.sweeps = 1;
  scene.pokes.emplace_back();
  scene.pokes[0].body = "c";
  scene.pokes[0].force = Vec3(0, speed * mass * 60, 0);  // in one step of 1/60 s
  return scene;
}

TEST(RelaxationGuard, TakesTheStepThatTheSweepsCannot) {
  World guarded(whipped(1e6, 60)), bare(whipped(1e6, 60));
  bare.workspace.setGuard(false);
  bare.steps(1);
  EXPECT_GT(maxStickError(bare.model, bare.state), 0.25);
  const StepReport report = guarded.steps(1);
  EXPECT_GT(report.implicit, 0);
  EXPECT_LT(maxStickError(guarded.model, guarded.state), 1e-6);
}

TEST(RelaxationGuard, LeavesWhatTheSweepsCanTakeToTheBit) {
  World guarded(whipped(1, 1)), bare(whipped(1, 1));
  bare.workspace.setGuard(false);
  bare.steps(60);
  EXPECT_EQ(guarded.steps(60).implicit, 0);
  EXPECT_EQ(hash(guarded.state), hash(bare.state));
}

}  // namespace
}  // namespace ragdoll
