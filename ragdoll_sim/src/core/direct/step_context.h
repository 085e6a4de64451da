// What a step, or a part of it, is taken in: model, inputs, state, scratch, tolerances.
#pragma once

#include <vector>

#include "core/direct/tolerances.h"
#include "core/mechanics/supports.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

struct ContactLog;
struct DirectWorkspace;

/// What all bodies of a step share.
struct StepContext {
  const Model& model;
  const Inputs& inputs;
  double h;             ///< [s] the whole step
  const Points* force;  ///< [N] 3 x N, of pokes; null: none
  bool guarded;         ///< false: the step guard is off, to measure what it costs
  /// The bodies come from relaxation: off their lengths and their groups' shape, and they move as
  /// it does, implicitly.
  bool relaxed;
  State& state;
  DirectWorkspace& ws;
  Supports& supports;
  ContactLog* log = nullptr;  ///< of this step; null: nobody asks
  int worker = 0;             ///< which thread takes the step: whose scratch it uses
  const std::vector<CachedImpulse>* before = nullptr;  ///< pressed before; null: the state's
  double whole = 0;  ///< [s] the step that h is a part of; 0: all of it
  Tolerances tolerances = tolerancesFor(h);
  /// Whether motions go from event to event, as the scene asks; false: by shake's steps.
  bool events = model.solver.method == Method::kRk && model.solver.events;

  bool isPart() const { return whole > 0; }
  double wholeStep() const { return isPart() ? whole : h; }
};

}  // namespace ragdoll
