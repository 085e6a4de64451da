// What comes into a simulation at the wrong moment.
#include "ragdoll_sim/world/simulation.h"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <thread>

#include "particles.h"
#include "ragdoll_sim/core/error.h"

namespace {

using ragdoll::Error;
using ragdoll::Simulation;
using ragdoll::World;
using ragdoll::test::particles;

constexpr std::uint64_t kLong = 30000;  ///< of ~step: half a minute if they were paced

class Paused : public ::testing::Test {
 protected:
  Paused() : simulation_(World(particles(1)), options()) {}
  static Simulation::Options options() {
    Simulation::Options options;
    options.paused = true;
    return options;
  }
  /// ~step in another thread; returns when it is under way.
  std::future<std::uint64_t> longStep() {
    const std::uint64_t begin = simulation_.progress().steps;
    auto reached = std::async(std::launch::async, [this] { return simulation_.step(kLong); });
    while (simulation_.progress().steps == begin) std::this_thread::yield();
    return reached;
  }
  std::uint64_t step() {
    return simulation_.call([](World& world) { return world.state().step; });
  }
  Simulation simulation_;
};

TEST_F(Paused, whoGoesOnDuringALongStepNeedNotWaitForItsTime) {
  std::uint64_t last = 0;
  for (std::uint64_t unpaused = 0; unpaused >= last;) {  // again, if it was already over
    simulation_.setPaused(true);
    auto steps = longStep();
    simulation_.setPaused(false);
    unpaused = step();
    last = steps.get();
  }
  // 100 paced steps take a tenth of a second; were the long step paced too, they would be due half
  // a minute later.
  const auto begin = Simulation::Clock::now();
  while (step() < last + 100) {
    ASSERT_LT(Simulation::Clock::now() - begin, std::chrono::seconds(20));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST_F(Paused, aJumpThatFailsLeavesALongStepAlone) {
  std::uint64_t last = 0;
  for (std::uint64_t failed = 0; failed >= last;) {  // again, if it was already over
    auto steps = longStep();
    EXPECT_THROW(simulation_.jump([&](World& world) {
      failed = world.state().step;
      throw Error("", "no snapshot");
    }),
                 Error);
    ASSERT_NO_THROW(last = steps.get());
  }
}

}  // namespace
