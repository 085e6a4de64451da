// Bodies and islands that do not touch are stepped in parallel: the same bits for any number of
// threads, whatever the method, with bodies that sleep, touch, are poked, or are handed on; and the
// same contacts for who asks.
#include <gtest/gtest.h>

#include "core/step/workspace.h"
#include "ragdoll_sim/core/contact_log.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "support/worlds.h"

namespace ragdoll {
namespace {

using namespace test;

/// All that a run comes to.
struct History {
  State state;
  StepReport sum;
  std::vector<double> contacts;  ///< every impulse of every step, in the order of the log
  int slept = 0, shared = 0;     ///< bodies' steps asleep; steps in which bodies pressed on others
};

struct Case {
  std::string name;
  std::string preset;
  std::string scene;
  double seconds;
  bool sleeps = false, touches = false, hands_on = false;  ///< what has to happen in it
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

constexpr char kApart[] =
    "ragdolls:\n"
    "  - {name: a, model: human, count: 5, spacing: [1.2, 0.3, 0.1], position: [0, 0, 1.1], "
    "rpy_deg: [80, 5, 20]}\n"
    "  - {name: b, model: human_lumped, position: [0, 3, 1.3], rpy_deg: [60, 0, 20]}\n"
    "obstacles: [{type: plane, friction: 0.8}]\n"
    "pokes: [{at: 0.1, body: a_2/head, force: [120, 30, 0], duration: 0.1}]\n";
/// Pairs that fall on each other, and one that falls alone.
constexpr char kPile[] =
    "ragdolls:\n"
    "  - {name: low, model: human, count: 3, spacing: [4, 4, 0], position: [0, 0, 1.1], "
    "rpy_deg: [0, -8, 0]}\n"
    "  - {name: high, model: human, count: 2, spacing: [4, 4, 0.05], position: [0.15, 0.1, 2.4], "
    "rpy_deg: [0, 80, 20]}\n"
    "ragdoll_collision: true\n"
    "obstacles: [{type: plane, friction: 0.8}]\n"
    "pokes: [{at: 0.2, body: low_1/pelvis, force: [0, 100, 300], duration: 0.1}]\n";
const std::string kFolded = std::string(kApart) + "self_collision: true\n";
/// Those, and one that is no tree.
const std::string kLoop = std::string(kApart) + "pins: [b/left_hand, b/right_hand]\n";
const std::string kDampedSolver = "solver: {damping: 3, joint_damping: 6}\n";

class Threads : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Methods, Threads,
    testing::Values(Case{"Shake", "balanced", kApart, 0.8}, Case{"Rk", "reference", kApart, 0.6},
                    Case{"ShakeOfPairs", "draft", kPile, 0.7, false, true},
                    Case{"Asleep", "draft", kPile + kDampedSolver, 5, true, true},
                    Case{"Fast", "fast", kApart, 1.5}, Case{"Thesis", "thesis", kPile, 0.7},
                    Case{"FastOfPairs", "fast", kPile, 1.5, false, true},
                    Case{"FastThatTouchesItself", "fast", kFolded, 1.5},
                    Case{"FastThatHandsOn", "fast", kLoop, 1.5, false, false, true}),
    [](const auto& info) { return info.param.name; });

History runOn(int threads, const Case& c) {
  Scene scene = parseScene(c.scene, "threads");
  const double damping = scene.solver.damping, joint_damping = scene.solver.joint_damping;
  scene.solver = preset(c.preset);
  scene.solver.damping = damping;
  scene.solver.joint_damping = joint_damping;
  scene.solver.threads = threads;
  World world(scene);
  ContactLog log;
  world.workspace.keepContacts(&log);
  History run;
  const int steps = static_cast<int>(c.seconds / scene.solver.step);
  for (int k = 0; k < steps; ++k) {
    run.sum += world.steps(1);
    for (const ContactImpulse& e : log.impulses)
      for (int i = 0; i < 3; ++i) run.contacts.push_back(e.impulse[i]);
    for (const std::uint8_t asleep : world.state.asleep) run.slept += asleep;
    run.shared += !world.workspace.impl().supports.pressing.empty();
  }
  run.state = world.state;
  return run;
}

void expectSame(const History& one, const History& many) {
  EXPECT_TRUE(many.state.x == one.state.x);
  EXPECT_TRUE(many.state.v == one.state.v);
  EXPECT_TRUE(many.state.multipliers == one.state.multipliers);
  EXPECT_TRUE(many.state.asleep == one.state.asleep);
  ASSERT_EQ(many.state.impulses.size(), one.state.impulses.size());
  for (std::size_t k = 0; k < one.state.impulses.size(); ++k) {
    EXPECT_EQ(many.state.impulses[k].ragdoll, one.state.impulses[k].ragdoll);
    EXPECT_EQ(many.state.impulses[k].impulse, one.state.impulses[k].impulse);
  }
  EXPECT_TRUE(many.contacts == one.contacts);
  EXPECT_EQ(many.sum.contacts, one.sum.contacts);
  EXPECT_EQ(many.sum.substeps, one.sum.substeps);
  EXPECT_EQ(many.sum.guarded, one.sum.guarded);
  EXPECT_EQ(many.sum.limited, one.sum.limited);
  EXPECT_EQ(many.sum.implicit, one.sum.implicit);
  EXPECT_EQ(many.sum.fast_fallbacks, one.sum.fast_fallbacks);
}

TEST_P(Threads, AnyNumberGivesTheSameBits) {
  const Case& c = GetParam();
  const History one = runOn(1, c);
  EXPECT_TRUE(one.state.x.allFinite());
  EXPECT_GT(one.sum.contacts, 0);
  if (c.sleeps) {
    EXPECT_GT(one.slept, 0);
  }
  if (c.touches) {
    EXPECT_GT(one.shared, 0);
  }
  if (c.hands_on) {
    EXPECT_GT(one.sum.fast_fallbacks, 0);
  }
  for (const int threads : {2, 3, 8}) {
    SCOPED_TRACE(threads);
    expectSame(one, runOn(threads, c));
  }
}

}  // namespace
}  // namespace ragdoll
