#include "ragdoll_sim/world/simulation.h"

#include <algorithm>
#include <cmath>

namespace ragdoll {
namespace {

using std::chrono::duration;
using std::chrono::duration_cast;
using std::chrono::milliseconds;

constexpr milliseconds kNap{2};  ///< shortest sleep; several short steps share one wake-up
/// Where steps are light, who looks at the world makes those that are due: one wake-up for both.
constexpr milliseconds kLongNap{100};
constexpr std::chrono::microseconds kLightStep{1000};  ///< a step that takes less is
constexpr milliseconds kMostCatchUp{2};                ///< for steps, by who looks
constexpr milliseconds kMaxLag{250};  ///< a simulation that is later than this does not catch up
constexpr milliseconds kPoll{1};      ///< how often another clock is looked at
constexpr std::chrono::minutes kLatenessWindow{1};
constexpr double kLongestStep = 1e6;  ///< [s] of wall time; slower is standing still
constexpr double kMaxClockJump = 1;   ///< [s] of another clock: more than this is not made up for,
constexpr double kTicks = 2.5;        ///< or than so many of its ticks, where it ticks slowly,
constexpr double kLongestTick = 60;   ///< [s] but not more slowly than this

}  // namespace

Simulation::Simulation(World world, Options options)
    : world_(std::move(world)),
      options_(std::move(options)),
      paused_(options_.paused),
      realtime_factor_(options_.realtime_factor) {
  rebase();
  thread_ = std::thread([this] { run(); });
}

Simulation::~Simulation() {
  end();
  thread_.join();
}

void Simulation::end() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
}

void Simulation::setPaused(bool paused) {
  call([&](World&) {
    if (paused_ && !paused) rebase();
    paused_ = paused;
  });
}

void Simulation::setRealtimeFactor(double factor) {
  call([&](World&) {
    if (factor == realtime_factor_) return;
    realtime_factor_ = factor;
    rebase();
  });
}

std::uint64_t Simulation::step(std::uint64_t steps) {
  std::future<std::uint64_t> reached = call([&](World& world) {
    if (!paused_) throw Error("", "the simulation is not paused");
    StepJob job{steps, {}};
    std::future<std::uint64_t> future = job.reached.get_future();
    if (steps == 0 && step_jobs_.empty())
      job.reached.set_value(world.state().step);
    else
      step_jobs_.push_back(std::move(job));
    return future;
  });
  try {
    return reached.get();
  } catch (const std::future_error&) {
    throw Error("", "interrupted: a reset, another state or the end came in between");
  }
}

void Simulation::copy(Snapshot& out) {
  World& world = world_;
  out.source = world.source();
  out.scene = world.scene();
  out.model = world.model();
  out.state = world.state();
  out.tracker = world.tracker();
  out.report = world.report();
  out.acted = world.takeActed();
  out.events = world.takeEvents();
  out.followed = world.takeFollowed();
  out.imu = world.takeImuSamples();
  out.contacts = world.takeContacts();
  out.pin_names = world.pinNames();
  out.pin_frames.clear();
  if (out.contacts) {
    for (const Pin& pin : out.model->pins)
      out.pin_frames.push_back(pin.frame.empty() ? std::nullopt : world.followedPose(pin.frame));
  }
  out.pulls = world.pulls();
  out.revision = world.revision();
  out.mark = world.mark();
  out.beginning = world.beginning();
  out.paused = paused_;
  out.realtime_factor = realtime_factor_;
  out.waiting = options_.external_clock && !(readClock() > 0);
  out.clock_silence.reset();
  if (options_.external_clock && !paused_)
    out.clock_silence = duration<double>(Clock::now() - ticked_).count();
  out.progress = progress_;
  out.lateness = last_lateness_;
  out.lateness.add(lateness_);
  out.alpha.reset();
}

void Simulation::snapshot(Snapshot& out) {
  look([&](World& world) {
    copy(out);
    if (paused_ || options_.external_clock || realtime_factor_ < 0) return;
    const double interval =
        duration<double>(wallStep()).count() * static_cast<double>(world.stepsPerFollow());
    const double age = duration<double>(Clock::now() - followed_due_).count();
    out.alpha = std::clamp(age / interval, 0.0, 1.0);
  });
}

void Simulation::sample(double every, std::function<void()> ready) {
  call([&](World&) {
    sample_every_ = every;
    sampled_ = std::move(ready);
  });
}

bool Simulation::takeSample(Snapshot& out) {
  {
    std::lock_guard<std::mutex> lock(samples_mutex_);
    if (samples_.empty()) return false;
    out = std::move(samples_.front());
    samples_.pop_front();
  }
  wake_.notify_all();
  return true;
}

bool Simulation::samplesAreFull() {
  if (!(sample_every_ > 0)) return false;
  std::lock_guard<std::mutex> lock(samples_mutex_);
  return samples_.size() >= kMostSamples;
}

/// After a step: if it is the first of its interval.
void Simulation::keepSample() {
  constexpr double kWithin = 1e-9;  // of an interval
  if (!(sample_every_ > 0)) return;
  const double time = world_.state().time;
  const auto interval = [&](double t) { return std::floor(t / sample_every_ + kWithin); };
  if (interval(time) == interval(time - world_.stepLength())) return;
  Snapshot now;
  copy(now);
  {
    std::lock_guard<std::mutex> lock(samples_mutex_);
    samples_.push_back(std::move(now));
  }
  sampled_();
}

Progress Simulation::progress() {
  return look([this](World&) { return progress_; });
}

void Simulation::post(Queued command) {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    if (!stopped_) {
      queue_.push_back(std::move(command));
      command = nullptr;
    }
  }
  if (command)
    command(false);
  else
    wake_.notify_all();
}

void Simulation::run() {
  for (;;) {
    makeOverdue();
    drain();
    {
      std::lock_guard<std::mutex> lock(mutex_);
      if (stopping_) break;
    }
    if (stepIsDue())
      advance();
    else
      waitForWork();
  }
  std::vector<Queued> rest;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopped_ = true;
    rest.swap(queue_);
  }
  for (const Queued& command : rest) command(false);
  endStepJobs();
}

void Simulation::drain() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    draining_.swap(queue_);
  }
  if (draining_.empty()) return;
  for (const Queued& command : draining_) command(true);
  draining_.clear();
  tellFollowing();
}

void Simulation::watchFollowing(std::function<void(bool)> told) {
  call([&](World&) {
    following_told_ = std::move(told);
    following_ = false;
  });
}

/// Only commands change what the world follows.
void Simulation::tellFollowing() {
  const bool follows = world_.followsFrames();
  if (follows == following_ || !following_told_) return;
  following_ = follows;
  following_told_(follows);
}

bool Simulation::stepIsDue() {
  if (samplesAreFull()) return false;
  if (!step_jobs_.empty()) return true;
  if (paused_) return false;
  if (realtime_factor_ < 0) return true;
  if (!options_.external_clock) {
    const bool due = Clock::now() >= due_;
    if (!due) given_up_ = {};
    return due;
  }
  const double now = readClock();
  if (now < external_due_ - world_.stepLength() / realtime_factor_ - kMaxClockJump)
    external_due_ = now;  // it was set back
  return now > external_due_;
}

double Simulation::readClock() {
  const double now = options_.external_clock();
  if (now == last_clock_) return now;
  last_tick_ = tick_;
  tick_ = now - last_clock_;
  last_clock_ = now;
  ticked_ = Clock::now();
  return now;
}

/// [s] of the other clock. A leap is one tick that is unlike the one before; a clock that ticks
/// slowly repeats itself.
double Simulation::mostBehind() const {
  const double tick = std::min({tick_, last_tick_, kLongestTick});
  return std::max(kMaxClockJump, kTicks * tick);
}

void Simulation::noteLateness(Clock::time_point begin) {
  if (!step_jobs_.empty() || realtime_factor_ < 0 || options_.external_clock) return;
  if (begin - lateness_begin_ > kLatenessWindow) {
    last_lateness_ = std::exchange(lateness_, Histogram());
    lateness_begin_ = begin;
  }
  lateness_.add(duration<double>(begin - std::max(due_, planned_) + given_up_).count());
}

void Simulation::advance() {
  const Clock::time_point begin = Clock::now();
  noteLateness(begin);
  world_.advance();
  const Clock::time_point end = Clock::now();
  light_ = end - begin < kLightStep;

  ++progress_.steps;
  progress_.simulated += world_.stepLength();
  progress_.stepping += duration<double>(end - begin).count();
  progress_.guarded += static_cast<std::uint64_t>(world_.report().guarded);
  progress_.implicit += static_cast<std::uint64_t>(world_.report().implicit);
  progress_.rigid += static_cast<std::uint64_t>(world_.report().rigid);
  progress_.joining += static_cast<std::uint64_t>(world_.report().joining);
  progress_.limited += static_cast<std::uint64_t>(world_.report().limited);
  progress_.unresolved += static_cast<std::uint64_t>(world_.report().unresolved);
  progress_.fast_fallbacks += static_cast<std::uint64_t>(world_.report().fast_fallbacks);
  if (world_.followedStep() == world_.state().step) followed_due_ = due_;
  keepSample();

  if (!step_jobs_.empty()) {
    StepJob& job = step_jobs_.front();
    if (job.left > 0) --job.left;
    while (!step_jobs_.empty() && step_jobs_.front().left == 0) {
      step_jobs_.front().reached.set_value(world_.state().step);
      step_jobs_.pop_front();
    }
    if (paused_) return;
    if (step_jobs_.empty()) rebase();  // it was unpaused meanwhile: the pace begins here
    return;
  }
  due_ += wallStep();
  external_due_ += world_.stepLength() / realtime_factor_;
  const bool late =
      options_.external_clock ? readClock() - external_due_ > mostBehind() : end - due_ > kMaxLag;
  if (late) giveUp();
}

void Simulation::makeOverdue() {
  if (paused_ || options_.external_clock || realtime_factor_ < 0 || !napsLong()) return;
  const Clock::time_point begin = Clock::now();
  while (Clock::now() < begin + kMostCatchUp && stepIsDue()) advance();
}

void Simulation::catchUp() {
  if (!long_nap_) return;
  planned_ = Clock::now();
  makeOverdue();
  behind_ = !napsLong() || stepIsDue();
  if (behind_) wake_.notify_all();
}

void Simulation::waitForWork() {
  std::unique_lock<std::mutex> lock(mutex_);
  const auto work = [this] { return stopping_ || behind_ || !queue_.empty(); };
  waits_ = true;
  if (paused_ && step_jobs_.empty())
    wake_.wait(lock, work);
  else if (options_.external_clock)
    wake_.wait_for(lock, kPoll, work);
  else {
    long_nap_ = napsLong();
    const Clock::time_point end = std::max(due_, Clock::now() + (long_nap_ ? kLongNap : kNap));
    planned_ = end;
    if (wake_.wait_until(lock, end, work)) planned_ = Clock::now();
  }
  waits_ = long_nap_ = behind_ = false;
}

void Simulation::endStepJobs() { step_jobs_.clear(); }

void Simulation::giveUp() {
  const Clock::duration before = given_up_ + (Clock::now() - due_);
  if (options_.external_clock && tick_ <= mostBehind())
    progress_.lost += last_clock_ - external_due_;
  rebase();
  if (!options_.external_clock) given_up_ = before;
}

void Simulation::rebase() {
  given_up_ = {};
  due_ = followed_due_ = Clock::now();
  if (options_.external_clock) external_due_ = readClock();
}

Simulation::Clock::duration Simulation::wallStep() const {
  if (realtime_factor_ < 0) return Clock::duration::zero();
  const double seconds = std::min(world_.stepLength() / realtime_factor_, kLongestStep);
  return duration_cast<Clock::duration>(duration<double>(seconds));
}

}  // namespace ragdoll
