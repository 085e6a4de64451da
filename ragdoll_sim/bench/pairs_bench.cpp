// Body against body: what the broad phase and a step cost as a crowd grows at constant density.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "core/contact/body_grid.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

/// Boxes of a man's size, one per 2.25 m^2.
std::vector<Bounds> crowd(int n) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  const double side = 1.5 * std::sqrt(n);
  std::vector<Bounds> boxes;
  for (int i = 0; i < n; ++i) {
    const Vec3 lo(side * unit(random), side * unit(random), unit(random));
    boxes.push_back({lo, lo + Vec3(0.9, 0.9, 1.8)});
  }
  return boxes;
}

void BM_BodyGrid(benchmark::State& b) {
  const std::vector<Bounds> boxes = crowd(static_cast<int>(b.range(0)));
  BodyGrid grid;
  for (auto _ : b) benchmark::DoNotOptimize(grid.findPairs(boxes));
  b.counters["compared_per_body"] = static_cast<double>(grid.compared()) / b.range(0);
  b.SetComplexityN(b.range(0));
}
BENCHMARK(BM_BodyGrid)->RangeMultiplier(4)->Range(16, 16384)->Complexity();

void runCrowd(benchmark::State& b, const std::string& flags) {
  const Model model = buildModel(
      parseScene("ragdolls: [{name: r, model: human, count: " + std::to_string(b.range(0)) +
                     ", spacing: [0.9, 0.9, 0], position: [0, 0, 1.2], rpy_deg: [10, 25, 0]}]\n"
                     "obstacles: [{type: plane, friction: 0.6}]\n"
                     "solver: {method: jakobsen, step: 0.004, sleep: false}\n" +
                     flags,
                 "bench"));
  State state = startState(model);
  const Inputs inputs = startInputs(model);
  Workspace workspace;
  for (int i = 0; i < 100; ++i) step(model, inputs, workspace, state);  // into the heap
  for (auto _ : b) step(model, inputs, workspace, state);
  b.SetComplexityN(b.range(0));
}
void BM_CrowdWithoutPairs(benchmark::State& b) { runCrowd(b, ""); }
void BM_CrowdSelf(benchmark::State& b) { runCrowd(b, "self_collision: true\n"); }
void BM_CrowdRagdolls(benchmark::State& b) { runCrowd(b, "ragdoll_collision: true\n"); }
BENCHMARK(BM_CrowdWithoutPairs)->RangeMultiplier(4)->Range(16, 256)->Complexity();
BENCHMARK(BM_CrowdSelf)->RangeMultiplier(4)->Range(16, 256)->Complexity();
BENCHMARK(BM_CrowdRagdolls)->RangeMultiplier(4)->Range(16, 256)->Complexity();

}  // namespace
}  // namespace ragdoll
