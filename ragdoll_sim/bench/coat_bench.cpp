// What following and coating one human costs per frame; two steps of a fall in turn.
#include <benchmark/benchmark.h>

#include "ragdoll_sim/body/angles.h"
#include "ragdoll_sim/body/coat.h"
#include "ragdoll_sim/body/skin.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace {

using namespace ragdoll;

struct Human {
  Model model = buildModel(loadScene("stairs"));
  FrameTracker tracker{model};
  State states[2];

  Human() {
    constexpr int kSteps = 70;  // in the air, limbs bent
    Workspace workspace;
    State state = startState(model);
    for (int i = 0; i < kSteps + 2; ++i) {
      if (i >= kSteps) states[i - kSteps] = state;
      step(model, startInputs(model), workspace, state);
    }
    tracker.reset(states[0]);
  }
};

void trackFrames(benchmark::State& state) {
  Human human;
  int i = 0;
  for (auto _ : state) human.tracker.update(human.states[i ^= 1]);
}
BENCHMARK(trackFrames);

void interpolateFrames(benchmark::State& state) {
  Human human;
  Posture posture;
  for (auto _ : state) human.tracker.interpolate(0.3, posture);
}
BENCHMARK(interpolateFrames);

void measureAngles(benchmark::State& state) {
  Human human;
  const JointAngles angles(human.model, human.tracker);
  std::vector<double> values;
  for (auto _ : state) angles.compute(human.tracker.now(), values);
}
BENCHMARK(measureAngles);

void wear(benchmark::State& state, CoatKind kind) {
  Human human;
  Coat coat(kind, human.model, human.tracker, 0);
  for (auto _ : state) coat.update(human.tracker.now());
}
BENCHMARK_CAPTURE(wear, sticks, CoatKind::kSticks);
BENCHMARK_CAPTURE(wear, boxes, CoatKind::kBoxes);
BENCHMARK_CAPTURE(wear, capsules, CoatKind::kCapsules);
BENCHMARK_CAPTURE(wear, skin, CoatKind::kSkin);

void blendSkin(benchmark::State& state, Blend blend) {
  Human human;
  const Skeleton& s = human.model.skeletons[0];
  const FrameTree& tree = human.tracker.tree(0);
  Skin skin(humanSkin(s, tree), s, tree);
  Mesh mesh = skin.rest();
  for (auto _ : state)
    skin.deform(human.states[0].x, human.tracker.now().parts.data(), blend, mesh);
}
BENCHMARK_CAPTURE(blendSkin, linear, Blend::kLinear);
BENCHMARK_CAPTURE(blendSkin, dual_quaternion, Blend::kDualQuaternion);

}  // namespace
