// Frames of simulated bodies: continuous through ten minutes of tumbling and through falls.
#include "ragdoll_sim/body/frames.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "../body/frame_law.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll::test {
namespace {

/// Steps a scene, poking a random particle every second; returns the largest step of a frame [rad].
double largestStep(const std::string& yaml, double seconds, double force) {
  const Scene scene = parseScene(yaml);
  const Model model = buildModel(scene);
  State state = startState(model);
  Workspace workspace;
  Inputs inputs;
  FrameTracker tracker(model);
  tracker.reset(state);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Skeleton& skeleton = model.skeletons[0];
  double largest = 0;
  const int steps = static_cast<int>(seconds / model.solver.step);
  const int second = static_cast<int>(1 / model.solver.step);
  for (int i = 0; i < steps && !testing::Test::HasFailure(); ++i) {
    if (i % second == 0) {
      Poke poke;
      poke.start = state.time;
      poke.duration = 0.1;
      poke.body_name = skeleton.particles[random() % skeleton.named];
      poke.body = findBody(model, poke.body_name);
      poke.force = force * Vec3(uniform(random), uniform(random), uniform(random));
      inputs.pokes.assign(1, poke);
    }
    step(model, inputs, workspace, state);
    tracker.update(state);
    for (int r = 0; r < tracker.ragdolls(); ++r)
      largest = std::max(largest, expectContinuous(tracker, r));
  }
  return largest;
}

std::string tumbling(const std::string& model) {
  return "gravity: [0, 0, 0]\n"
         "ragdolls: [{model: " +
         model +
         ", angular_velocity: [1.5, 2.0, 0.6]}]\n"
         "solver: {preset: thesis, damping: 0.2}\n";
}

TEST(SimulatedFrames, TenMinutesOfTumbling) {
  EXPECT_LT(largestStep(tumbling("human"), 600, 150), 2.0);
}

TEST(SimulatedFrames, TenMinutesOfTumblingWithTheThesisLimits) {
  EXPECT_LT(largestStep(tumbling("human_thesis"), 600, 150), 2.0);
}

TEST(SimulatedFrames, FallOntoTheFloor) {
  for (const std::string preset : {"thesis", "balanced"})
    EXPECT_LT(largestStep("ragdolls: [{model: human, position: [0, 0, 2], rpy_deg: [40, 70, 0]}]\n"
                          "obstacles: [{type: plane}]\n"
                          "solver: {preset: " +
                              preset + "}\n",
                          10, 100),
              2.0)
        << preset;
}

}  // namespace
}  // namespace ragdoll::test
