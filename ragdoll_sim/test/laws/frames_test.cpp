// Frames of simulated bodies: continuous through ten minutes of tumbling and through falls.
#include "ragdoll_sim/body/frames.h"

#include <gtest/gtest.h>

#include <ostream>
#include <random>
#include <string>

#include "../body/frame_law.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/samples.h"

namespace ragdoll::test {
namespace {

/// Steps a scene, poking a random particle every second.
FrameRecord follow(const std::string& yaml, double seconds, double force) {
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
  FrameRecord record;
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
    for (int r = 0; r < tracker.ragdolls(); ++r) expectContinuous(tracker, r, record);
  }
  return record;
}

struct Tumbling {
  const char* model;
  const char* preset;
  friend std::ostream& operator<<(std::ostream& out, const Tumbling& t) {
    return out << t.model << ", " << t.preset;
  }
};

class TenMinutes : public testing::TestWithParam<Tumbling> {};

INSTANTIATE_TEST_SUITE_P(OfTumbling, TenMinutes,
                         testing::Values(Tumbling{"human", "thesis"}, Tumbling{"human", "balanced"},
                                         Tumbling{"human_lumped", "balanced"},
                                         Tumbling{"human_thesis", "thesis"}));

TEST_P(TenMinutes, NoFrameTurnsByMoreThanTheMotionExplains) {
  const FrameRecord record =
      follow("gravity: [0, 0, 0]\nragdolls: [{model: " + std::string(GetParam().model) +
                 ", angular_velocity: [1.5, 2.0, 0.6]}]\nsolver: {preset: " + GetParam().preset +
                 ", damping: 0.2}\n",
             samples(600), 150);
  EXPECT_LT(record.share(), kTurned);  // and in each step follow() expects the law
  RecordProperty("share", std::to_string(record.share()));
}

TEST(SimulatedFrames, FallOntoTheFloor) {
  for (const std::string preset : {"thesis", "balanced"})
    EXPECT_LT(follow("ragdolls: [{model: human, position: [0, 0, 2], rpy_deg: [40, 70, 0]}]\n"
                     "obstacles: [{type: plane}]\n"
                     "solver: {preset: " +
                         preset + "}\n",
                     10, 100)
                  .share(),
              kTurned)
        << preset;
}

}  // namespace
}  // namespace ragdoll::test
