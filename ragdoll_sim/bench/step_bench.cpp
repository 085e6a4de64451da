// Cost of one step of one human, by method and by what the scene requires. Look at the CPU column.
#include <benchmark/benchmark.h>

#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

constexpr double kRunSeconds = 2;  ///< simulated time after which a run starts again: fall and rest

constexpr char kOnPlane[] =
    "position: [0, 0, 1.5], rpy_deg: [10, 20, 0]}]\n"
    "obstacles: [{type: plane, point: [0, 0, 0], normal: [0, 0, 1], friction: 0.6}]\n";
constexpr char kWeightless[] =
    "angular_velocity: [1, 2, 3]}]\n"
    "gravity: [0, 0, 0]\n";

struct Case {
  const char* name;
  const char* model;
  const char* place;
  const char* solver;
  bool limits;
};

constexpr Case kCases[] = {
    {"step/jakobsen_10_sweeps/on_plane/thesis_body_without_limits", "human_thesis", kOnPlane,
     "{preset: thesis}", false},
    {"step/jakobsen_10_sweeps/on_plane/thesis_body_with_limits", "human_thesis", kOnPlane,
     "{preset: thesis}", true},
    {"step/jakobsen_10_sweeps/on_plane/human_with_limits", "human", kOnPlane, "{preset: thesis}",
     true},
    {"step/jakobsen_10_sweeps/weightless/thesis_body_without_limits", "human_thesis", kWeightless,
     "{preset: thesis}", false},
    {"step/default/on_plane/human_with_limits", "human", kOnPlane, "{}", true},
    {"step/default/weightless/human_with_limits", "human", kWeightless, "{}", true},
};

/// The joints of every body taken away.
void dropLimits(Scene& scene) {
  for (RagdollSpec& ragdoll : scene.ragdolls) {
    auto skeleton = std::make_shared<SkeletonSpec>(*ragdoll.skeleton);
    skeleton->joints.clear();
    ragdoll.skeleton = skeleton;
  }
}

/// Runs the scene from its start, again and again, so that every phase of the fall counts.
void runScene(benchmark::State& bench, const Case& what) {
  Scene scene = parseScene(std::string("ragdolls: [{model: ") + what.model + ", " + what.place +
                               "solver: " + what.solver + "\n",
                           "bench");
  if (!what.limits) dropLimits(scene);
  scene.solver.sleep = false;  // a sleeping body would flatter the mean
  const Model model = buildModel(scene);
  const State start = startState(model);
  const Inputs inputs = startInputs(model);
  const int steps_per_run = static_cast<int>(kRunSeconds / model.solver.step);
  Workspace workspace;
  State state = start;
  int n = 0;
  for (auto _ : bench) {
    if (++n == steps_per_run) {
      state = start;
      n = 0;
    }
    step(model, inputs, workspace, state);
  }
  bench.counters["cpu_per_simulated_second"] =
      benchmark::Counter(model.solver.step, benchmark::Counter::kIsIterationInvariantRate |
                                                benchmark::Counter::kInvert);
}

const bool kRegistered = [] {
  for (const Case& what : kCases)
    benchmark::RegisterBenchmark(what.name, [&what](benchmark::State& b) { runScene(b, what); });
  return true;
}();

}  // namespace
}  // namespace ragdoll
