#include "metrics.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/findings.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/number_text.h"
#include "ragdoll_sim/core/solver_presets.h"
#include "ragdoll_sim/ros/convert.h"
#include "ragdoll_sim/world/text.h"

namespace ragdoll {
namespace {

constexpr double kMetricsPeriod = 1;  ///< [s]
constexpr double kTooSlow = 0.95;     ///< of the wanted real-time factor
constexpr double kClockSilence = 5;   ///< [s] without a tick of /clock

std::string describe(const SolverSpec& solver) {
  std::string text = methodNames().at(static_cast<std::size_t>(solver.method));
  if (solver.method == Method::kJakobsen) text += ", " + std::to_string(solver.sweeps) + " sweeps";
  char step[32];
  std::snprintf(step, sizeof step, ", step %.6g s", solver.step);
  return text + step + " (preset " + solver.preset + ")";
}

std::vector<std::string> outOfReach(const Model& model, const State& state) {
  std::vector<std::string> names;
  for (const Ragdoll& r : model.ragdolls)
    if (!isWithinReach(state.x.col(r.first))) names.push_back(r.name);
  return names;
}

}  // namespace

Metrics::Metrics(ros::NodeHandle& nh, Troubles troubles)
    : troubles_(std::move(troubles)),
      updater_(ros::NodeHandle(), nh, nh.getNamespace()),
      last_(Simulation::Clock::now()) {
  publisher_ = nh.advertise<ragdoll_msgs::Metrics>("metrics", 10);
  updater_.setHardwareID("none");
  updater_.add("simulation", this, &Metrics::diagnose);
}

void Metrics::publish(const Snapshot& world, const std_msgs::Header& header) {
  const double seconds = std::chrono::duration<double>(Simulation::Clock::now() - last_).count();
  if (seconds < kMetricsPeriod) return;
  last_ = Simulation::Clock::now();
  measure(world, seconds);
  message_.header = header;
  if (publisher_.getNumSubscribers() > 0) {
    const Model& model = *world.model;
    message_.kinetic_energy = kineticEnergy(model, world.state);
    message_.potential_energy = potentialEnergy(model, world.state);
    message_.max_stick_error = maxStickError(model, world.state);
    message_.max_penetration = maxPenetration(model, world.state);
    message_.max_limit_violation = maxLimitViolation(model, world.state);
    publisher_.publish(message_);
  }
  updater_.force_update();
}

void Metrics::measure(const Snapshot& world, double seconds) {
  const Progress& now = world.progress;
  since_.steps = now.steps - before_.steps;
  since_.simulated = now.simulated - before_.simulated;
  since_.stepping = now.stepping - before_.stepping;
  since_.guarded = now.guarded - before_.guarded;
  since_.implicit = now.implicit - before_.implicit;
  since_.rigid = now.rigid - before_.rigid;
  since_.joining = now.joining - before_.joining;
  since_.limited = now.limited - before_.limited;
  since_.unresolved = now.unresolved - before_.unresolved;
  since_.fast_fallbacks = now.fast_fallbacks - before_.fast_fallbacks;
  since_.lost = now.lost - before_.lost;
  before_ = now;
  was_paused_ = paused_;
  paused_ = world.paused;
  wanted_factor_ = world.realtime_factor;
  clock_silence_ = world.clock_silence;
  message_.paused = world.paused;
  message_.waiting = world.waiting;
  message_.step_lateness_p50 = world.lateness.percentile(0.5);
  message_.step_lateness_p99 = world.lateness.percentile(0.99);
  message_.step_lateness_p999 = world.lateness.percentile(0.999);
  message_.step_lateness_max = world.lateness.max();
  message_.realtime_factor =
      pace_.after(since_.simulated, seconds, clock_silence_ && !world.paused);
  message_.step_time = since_.steps > 0 ? since_.stepping / static_cast<double>(since_.steps) : 0;
  message_.contacts = static_cast<std::uint32_t>(world.report.contacts +
                                                 contactsOfSleepers(*world.model, world.state));
  message_.asleep = static_cast<std::uint32_t>(std::count_if(
      world.state.asleep.begin(), world.state.asleep.end(), [](auto a) { return a; }));
  message_.ragdolls = static_cast<std::uint32_t>(world.model->ragdolls.size());
  message_.solver = describe(world.model->solver);
  message_.guarded = static_cast<std::uint32_t>(since_.guarded);
  message_.implicit = static_cast<std::uint32_t>(since_.implicit);
  message_.rigid = static_cast<std::uint32_t>(since_.rigid);
  message_.joining = static_cast<std::uint32_t>(since_.joining);
  message_.limited = static_cast<std::uint32_t>(since_.limited);
  message_.unresolved = static_cast<std::uint32_t>(since_.unresolved);
  message_.fast_fallbacks = static_cast<std::uint32_t>(since_.fast_fallbacks);
  message_.error_class = errorClass(world.model->solver);
  out_of_reach_ = outOfReach(*world.model, world.state);
  overlaps_ = deepOverlaps(*world.model, world.state);
}

/// Of the clock that is followed: its pace is none of the simulation's business.
void Metrics::diagnoseClock(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (*clock_silence_ > kClockSilence)
    status.mergeSummary(DiagnosticStatus::WARN, "stands still: /clock has not ticked for " +
                                                    numberText(std::round(*clock_silence_)) + " s");
  else if (since_.lost > (1 - kTooSlow) * (since_.lost + since_.simulated))
    status.mergeSummary(DiagnosticStatus::WARN, "slower than /clock");
}

void Metrics::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  status.summary(DiagnosticStatus::OK, paused_ ? "paused" : "running");
  if (message_.waiting)
    status.mergeSummary(DiagnosticStatus::WARN,
                        "waiting for /clock: /use_sim_time is set and nobody has published a time");
  else if (clock_silence_)
    diagnoseClock(status);
  else if (!paused_ && !was_paused_ && message_.realtime_factor < kTooSlow * wanted_factor_)
    status.mergeSummary(DiagnosticStatus::WARN, "slower than real time is wanted");
  if (since_.rigid > 0)
    status.mergeSummary(DiagnosticStatus::WARN,
                        "beyond what the solver can do: some motions were taken with the joints "
                        "frozen; look for huge forces, squeezing obstacles or a too large step");
  if (since_.unresolved > 0)
    status.mergeSummary(DiagnosticStatus::WARN,
                        "constraints did not converge in some steps; look for obstacles, bodies or "
                        "pins that leave a body no room, or for a too small tolerance");
  if (!out_of_reach_.empty())
    status.mergeSummary(DiagnosticStatus::WARN, "farther out than " + numberText(kFarthest) +
                                                    " m, where numbers are too " +
                                                    "coarse for a body: " + listed(out_of_reach_) +
                                                    "; ~reset brings it back");
  if (!overlaps_.empty())
    status.mergeSummary(DiagnosticStatus::WARN,
                        listed(overlaps_) + "; ~reset, or move one of them");
  const std::vector<std::string> missing = troubles_.missing();
  if (!missing.empty())
    status.mergeSummary(DiagnosticStatus::WARN, "no news from TF of " + joined(missing));
  const std::vector<std::string> rivals = troubles_.rivals();
  if (!rivals.empty())
    status.mergeSummary(DiagnosticStatus::WARN,
                        joined(rivals) + "; give one of them another ~frame_prefix");
  const std::vector<std::string> clocks = troubles_.clocks();
  if (!clocks.empty())
    status.mergeSummary(DiagnosticStatus::WARN,
                        "/clock is published by " + joined(clocks) +
                            ", too: end one of them, or start it without ~publish_clock");
  status.add("real-time factor", message_.realtime_factor);
  status.add("time of a step [us]", 1e6 * message_.step_time);
  status.add("lateness of steps, 50 % [us]", 1e6 * message_.step_lateness_p50);
  status.add("lateness of steps, 99 % [us]", 1e6 * message_.step_lateness_p99);
  status.add("lateness of steps, 99.9 % [us]", 1e6 * message_.step_lateness_p999);
  status.add("lateness of steps, largest [us]", 1e6 * message_.step_lateness_max);
  status.add("solver", message_.solver);
  status.add("ragdolls", message_.ragdolls);
  status.add("asleep", message_.asleep);
  status.add("contacts", message_.contacts);
  status.add("steps guarded", since_.guarded);
  status.add("implicit steps", since_.implicit);
  status.add("steps with the joints frozen", since_.rigid);
  status.add("steps that joined sticks from far", since_.joining);
  status.add("steps with energy limited", since_.limited);
  status.add("steps unresolved", since_.unresolved);
  status.add("steps handed on by fast", since_.fast_fallbacks);
}

}  // namespace ragdoll
