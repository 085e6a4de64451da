// Runs a World on a thread of its own, paced by a steady clock, by another clock, or free.
//
// Others reach the world only through call(): a command waits in a queue that is drained between
// steps, so the physics never waits for anyone; or, to read it, through look(). Knows nothing of
// ROS.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/histogram.h"
#include "ragdoll_sim/world/snapshot.h"
#include "ragdoll_sim/world/world.h"

namespace ragdoll {

class Simulation {
 public:
  using Clock = std::chrono::steady_clock;

  struct Options {
    double realtime_factor = 1;  ///< -1: free
    bool paused = false;
    /// [s] the clock to follow instead of the steady one; time stands still while it does.
    std::function<double()> external_clock;
  };

  Simulation(World world, Options options);
  ~Simulation();

  /// Ends after the present step; who waits in call() or step() gets an Error. Does not wait.
  void end();

  /// Runs command(World&) between two steps and returns what it returns; exceptions come through.
  /// Throws Error when the simulation has ended. Not to be called from a command.
  template <class Command>
  auto call(Command command) -> decltype(command(std::declval<World&>())) {
    using Result = decltype(command(world_));
    std::packaged_task<Result()> task([&] { return command(world_); });
    std::future<Result> result = task.get_future();
    post([&task](bool alive) {
      if (alive)
        task();
      else
        task = {};  // breaks the promise
    });
    try {
      return result.get();
    } catch (const std::future_error&) {
      throw Error("", "the simulation has ended");
    }
  }

  /// call() for what leaves pace and steps alone: at once, on the caller's own thread, while the
  /// simulation waits, so that nobody has to be woken; after the steps that are due, if they are
  /// light.
  template <class Command>
  auto look(Command command) -> decltype(command(std::declval<World&>())) {
    {
      std::lock_guard<std::mutex> lock(mutex_);
      if (waits_ && queue_.empty()) {
        catchUp();
        return command(world_);
      }
    }
    return call(std::move(command));
  }

  /// `told` is called, from the simulation's own thread, with whether the world follows frames of
  /// others: now, and when that changes. Empty: no more.
  void watchFollowing(std::function<void(bool)> told);

  void setPaused(bool paused);
  bool paused() const { return paused_; }

  /// Makes `steps` steps as fast as it can while paused. Returns the step reached. Throws Error if
  /// not paused, or if a jump (reset, another scene) came in between.
  std::uint64_t step(std::uint64_t steps);

  /// call() for commands that replace the state: ends what step() is waiting for, unless it throws.
  template <class Command>
  void jump(Command command) {
    call([&](World& world) {
      command(world);
      endStepJobs();
      rebase();
    });
  }

  void snapshot(Snapshot& out);

  /// From now on keeps a copy of the first moment of each `every` [s] of simulated time; calls
  /// `ready` when there is one, from its own thread. Steps wait while kMostSamples are not taken.
  void sample(double every, std::function<void()> ready);
  /// The oldest; false if there is none.
  bool takeSample(Snapshot& out);
  Progress progress();

  double realtimeFactor() const { return realtime_factor_; }
  void setRealtimeFactor(double factor);  ///< > 0; -1: free

 private:
  using Queued = std::function<void(bool alive)>;
  struct StepJob {
    std::uint64_t left;
    std::promise<std::uint64_t> reached;
  };

  static constexpr std::size_t kMostSamples = 100;

  void post(Queued command);
  void copy(Snapshot& out);
  void keepSample();
  bool samplesAreFull();
  void run();
  void drain();
  void tellFollowing();
  bool stepIsDue();
  void noteLateness(Clock::time_point begin);
  void advance();
  void waitForWork();
  bool napsLong() const { return light_ && !(sample_every_ > 0); }
  /// Makes the steps that a long nap has left.
  void makeOverdue();
  /// The same while the simulation's own thread waits, which is woken if that would take too long.
  void catchUp();
  void endStepJobs();
  void rebase();       ///< the next step is due now
  double readClock();  ///< [s] the other clock; learns how it ticks
  double mostBehind() const;
  void giveUp();  ///< the same, as it is too late to catch up
  Clock::duration wallStep() const;

  World world_;
  Options options_;
  std::atomic<bool> paused_;
  std::atomic<double> realtime_factor_;
  Clock::time_point due_, followed_due_;
  Clock::time_point planned_;   ///< when steps that are due are to be made, if later
  Clock::duration given_up_{};  ///< how late it was when it last gave up, until it is in time again
  double external_due_ = 0;
  double last_clock_ = 0;            ///< [s] of the other clock when it was looked at last
  double tick_ = 0, last_tick_ = 0;  ///< [s] its last two
  Clock::time_point ticked_ = Clock::now();
  Progress progress_;
  std::deque<StepJob> step_jobs_;
  /// [s] How late steps began by the steady clock: the minute that runs, and the one before.
  Histogram lateness_, last_lateness_;
  Clock::time_point lateness_begin_ = Clock::now();

  std::function<void(bool)> following_told_;
  bool following_ = false;  ///< what was told

  double sample_every_ = 0;  ///< [s]
  std::function<void()> sampled_;
  std::mutex samples_mutex_;
  std::deque<Snapshot> samples_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<Queued> queue_;
  std::vector<Queued> draining_;
  bool stopping_ = false, stopped_ = false;
  bool waits_ = false;  ///< its thread, in waitForWork(): whoever has mutex_ has the world
  bool light_ = false;  ///< the last step was
  bool long_nap_ = false;
  bool behind_ = false;  ///< who looked left steps that are due to its thread
  std::thread thread_;   // last: starts when all else is there
};

}  // namespace ragdoll
