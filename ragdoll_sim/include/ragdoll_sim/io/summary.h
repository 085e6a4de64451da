// What a run did, in numbers: watched from outside, step by step, and written as JSON.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/core/trees.h"

namespace ragdoll {

/// How often the step guard did what; a step counts once however many ragdolls it was for.
struct GuardCounts {
  std::uint64_t guarded = 0;     ///< steps in which the method or the step was changed
  std::uint64_t implicit = 0;    ///< implicit steps taken in place of explicit ones
  std::uint64_t rigid = 0;       ///< motions with the joints frozen, where implicit steps failed
  std::uint64_t joining = 0;     ///< steps in which sticks were drawn to their lengths from far
  std::uint64_t limited = 0;     ///< steps in which energy was limited (StepReport)
  std::uint64_t unresolved = 0;  ///< steps whose constraints did not converge
  int max_substeps = 1;
  std::uint64_t fast_fallbacks = 0;    ///< method fast: bodies' steps that shake took
  std::uint64_t handed_over = 0;       ///< method rk: bodies' motions that shake took
  std::uint64_t tolerance_missed = 0;  ///< steps whose error was larger than the tolerance
};

struct Summary {
  std::uint64_t steps = 0;
  double seconds = 0;                       ///< [s] simulated
  double wall_seconds = 0;                  ///< [s] spent in step() alone
  double max_stick_error = 0;               ///< relative, largest of all steps
  double max_penetration = 0;               ///< [m] largest of all steps
  double max_limit_violation = 0;           ///< [rad] largest of all steps
  double energy_start = 0, energy_end = 0;  ///< [J] kinetic and potential
  double start_energy_taken = 0;            ///< [J] by what made the start consistent (startState)
  double work = 0;                          ///< [J] done by pokes (force times way, step by step)
  double max_energy_rise = 0;               ///< [J] largest of energy - (energy_start + work), >= 0
  double error_estimate = 0;                ///< [m/s] largest of all steps (StepReport)
  GuardCounts guard;
  std::optional<Vec3> contact_impulse;  ///< [N s] of obstacles on all bodies, if it was kept
  /// Indicators of injury, if they were kept: per "ragdoll/head" [1], [g]; per region that was
  /// touched, "ragdoll/torso", [N], [J].
  std::vector<std::pair<std::string, double>> hic15, peak_g, peak_force, approach_energy;
  std::vector<TreeFinding> trees;  ///< of the scene's models
  int asleep = 0;                  ///< ragdolls asleep at the end
  std::uint64_t hash = 0;          ///< of the last state
  bool finite = true;              ///< every position and velocity was a number
};

/// {"steps": ..., ..., "hash": "<16 hex digits>"}, ending in a newline.
std::string toJson(const Summary& summary);

/// Runs a world and keeps its Summary.
class WatchedRun {
 public:
  explicit WatchedRun(const Model& model);

  /// One step, timed and measured.
  void step();

  /// Where the obstacles are at the end of the next step; one pose each.
  void moveObstacles(const std::vector<Pose>& poses) { inputs_.obstacles = poses; }
  /// The same of the pins.
  void movePins(const std::vector<Vec3>& positions) { inputs_.pins = positions; }

  /// As of Workspace.
  void keepContacts(ContactLog* log) { workspace_.keepContacts(log); }

  const Inputs& inputs() const { return inputs_; }
  const State& state() const { return state_; }
  double time() const;  ///< [s] steps times step length
  Summary summary() const;

 private:
  void measure();
  double energy() const;

  const Model& model_;
  Inputs inputs_;
  Workspace workspace_;
  State state_;
  Points before_, force_;
  Summary summary_;
};

}  // namespace ragdoll
