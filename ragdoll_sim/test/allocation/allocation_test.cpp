// No step but a workspace's first asks for memory: every call of malloc within step() counts.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstddef>

#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/direct_island.h"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RAGDOLL_COUNTS_MALLOC 1
#endif

namespace {

std::atomic<bool> counts{false};
std::atomic<long> allocations{0};

#ifdef RAGDOLL_COUNTS_MALLOC
/// A place to stop at in a debugger: who calls it allocates within a step.
__attribute__((noinline)) void allocated() { allocations.fetch_add(1); }
#endif

}  // namespace

#ifdef RAGDOLL_COUNTS_MALLOC
// operator new and Eigen come down to these.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  if (counts) allocated();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  if (counts) allocated();
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  if (counts) allocated();
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  if (counts) allocated();
  return __libc_memalign(alignment, size);
}
}
#endif

namespace ragdoll {
namespace {

using test::World;

struct Case {
  std::string name;    ///< of the case
  std::string scene;   ///< that is shipped, or "two models", "chain"
  std::string solver;  ///< preset
  double seconds;
  bool moves = false;  ///< pins and obstacles
  double force = 0;    ///< [N] on a chain for a step: so much that the guard acts
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

class Allocation : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, Allocation,
                         testing::Values(Case{"AFallingBody", "weightless", "balanced", 2},
                                         Case{"ABodyInContact", "fall", "balanced", 3},
                                         Case{"ABodyOnStairs", "stairs", "balanced", 3},
                                         Case{"AHungBody", "hang", "balanced", 2},
                                         Case{"APinThatMoves", "hang", "balanced", 2, true},
                                         Case{"AnObstacleThatMoves", "between_objects", "balanced",
                                              2, true},
                                         Case{"BodiesThatTouchBodies", "two", "balanced", 4},
                                         Case{"BodiesThatTouchInSmallSteps", "two", "precise", 1.5},
                                         Case{"ImplicitSteps", "chain", "balanced", 1, false, 1e9},
                                         Case{"BodiesOfTwoModels", "two models", "balanced", 2},
                                         Case{"Relaxation", "stairs", "thesis", 3},
                                         Case{"RelaxedBodiesThatTouch", "two", "thesis", 4},
                                         Case{"RungeKutta", "fall", "reference", 1.5},
                                         Case{"FromEventToEvent", "fall", "events", 1},
                                         Case{"BodiesFromEventToEvent", "two", "events", 0.5},
                                         Case{"Packs", "stairs", "fast", 4},
                                         Case{"BodiesThatTouchAtSixty", "two", "fast", 4},
                                         Case{"WithinATolerance", "fall", "tolerance", 1.2},
                                         Case{"AdaptiveRungeKutta", "hang", "adaptive", 1}),
                         [](const auto& info) { return info.param.name; });

constexpr char kTwoModels[] =
    "obstacles: [{type: plane}]\n"
    "ragdoll_collision: true\n"
    "ragdolls: [{name: a, model: human, position: [0, 0, 1.2]},\n"
    "           {name: b, model: human_lumped, position: [5, 0, 1.2]}]\n";

World worldOf(const Case& c) {
  Scene scene = c.scene == "two models" ? parseScene(kTwoModels)
                : c.scene == "chain"    ? test::weightless(test::chainOfThree())
                                        : loadScene(c.scene);
  const bool rk = c.solver == "adaptive" || c.solver == "events";
  scene.solver = preset(rk ? "reference" : c.solver == "tolerance" ? "balanced" : c.solver);
  scene.solver.events = c.solver == "events";
  if (c.solver == "adaptive") scene.solver.tolerance = 1e-6;
  if (c.solver == "tolerance") scene.solver.tolerance = 1e-3;
  scene.solver.joint_damping = 2;
  if (c.force > 0) {
    scene.pokes.emplace_back();
    scene.pokes[0].body = "c";
    scene.pokes[0].at = 0.2;
    scene.pokes[0].force = Vec3(c.force, 0, -c.force);
  }
  return World(scene);
}

/// What moves does so to and fro by 0.2 m.
void setInputs(const World& world, double time, Inputs& inputs) {
  const double way = 0.2 * std::sin(3 * time);
  for (std::size_t k = 0; k < inputs.pins.size(); ++k)
    inputs.pins[k] = world.model.pins[k].target + Vec3(way, 0, 0);
  for (std::size_t k = 0; k < inputs.obstacles.size(); ++k) {
    inputs.obstacles[k] = world.model.obstacles[k].pose;
    inputs.obstacles[k].position.x() += way;
  }
}

/// Calls of malloc in the steps of a run.
struct Calls {
  long first_step = 0, later = 0;
  int implicit = 0;  ///< steps
};

Calls run(const Case& c, World& world) {
  const double h = world.model.solver.step;
  const int steps = static_cast<int>(std::lround(c.seconds / h));
  Calls calls;
  for (int i = 0; i < steps; ++i) {
    setInputs(world, (i + 1) * h, world.inputs);
    allocations = 0;
    counts = true;
    const StepReport report = step(world.model, world.inputs, world.workspace, world.state);
    counts = false;
    (i == 0 ? calls.first_step : calls.later) += allocations;
    calls.implicit += report.implicit;
  }
  return calls;
}

TEST_P(Allocation, NoneInAStepAfterTheFirst) {
#ifndef RAGDOLL_COUNTS_MALLOC
  GTEST_SKIP() << "needs glibc's malloc, without a sanitizer's";
#endif
  const Case& c = GetParam();
  World world = worldOf(c);
  if (c.moves) {
    world.inputs.pins.resize(world.model.pins.size());
    world.inputs.obstacles.resize(world.model.obstacles.size());
  }
  const Calls calls = run(c, world);
  EXPECT_GT(calls.first_step, 0) << "nothing is counted";
  EXPECT_EQ(calls.later, 0);
  if (c.force > 0) {
    EXPECT_GT(calls.implicit, 0);
  }
}

}  // namespace
}  // namespace ragdoll
