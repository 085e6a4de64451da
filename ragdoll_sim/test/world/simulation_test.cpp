// What comes into a simulation at the wrong moment.
#include "ragdoll_sim/world/simulation.h"

#include <gtest/gtest.h>

#include <atomic>
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

/// [s] A test that waits longer has failed.
constexpr std::chrono::seconds kLimit(30);

template <class Condition>
bool waitFor(Condition condition) {
  const auto end = Simulation::Clock::now() + kLimit;
  while (!condition()) {
    if (Simulation::Clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

TEST(Pace, latenessTellsHowFarBehindItIs) {
  Simulation::Options options;
  options.realtime_factor = 1e6;  // more than any machine can
  Simulation simulation(World(particles(1)), options);
  ragdoll::Snapshot now;
  EXPECT_TRUE(waitFor([&] {
    simulation.snapshot(now);
    return now.lateness.max() > 1;
  }));
}

/// Another clock, set by hand.
class Clocked : public ::testing::Test {
 protected:
  Clocked() : simulation_(World(particles(1)), options()) {}
  Simulation::Options options() {
    Simulation::Options options;
    options.external_clock = [this] { return clock_.load(); };
    return options;
  }
  double time() {
    return simulation_.call([](World& world) { return world.state().time; });
  }
  /// Whether the simulation goes on by so much when the clock does.
  bool tick(double seconds) {
    const double before = time();
    clock_ = clock_ + seconds;
    return waitFor([&] { return time() >= before + seconds - 0.01; });
  }
  std::atomic<double> clock_{100};
  Simulation simulation_;
};

TEST_F(Clocked, aClockThatTicksSlowlyIsFollowed) {
  ASSERT_TRUE(tick(0.5));
  clock_ = clock_ + 4;  // the first slow tick may be a leap
  ASSERT_TRUE(waitFor([&] { return time() > 0.5; }));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(tick(4)) << i;
  ragdoll::Snapshot now;
  simulation_.snapshot(now);
  EXPECT_LT(now.progress.lost, 0.01);
}

TEST_F(Clocked, aLeapIsNotMadeUpFor) {
  ASSERT_TRUE(tick(0.5));
  clock_ = clock_ + 1000;  // seen when the simulation looks, maybe with what follows
  const double before = time();
  ASSERT_TRUE(waitFor([&] {
    clock_ = clock_ + 0.01;
    return time() > before + 0.3;
  }));
  EXPECT_LT(time(), 2);
}

}  // namespace
