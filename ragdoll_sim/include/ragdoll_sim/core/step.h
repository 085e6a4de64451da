// One step of the world. The single entry for every method; what it starts from: build_model.h.
#pragma once

#include <memory>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

struct ContactLog;  // contact_log.h

/// Scratch memory of one model, which grows with what a run meets and never shrinks: a step that
/// meets no more contacts and limits at once than those before it allocates nothing
/// (test/allocation), but for the guard's last resorts. Where the model changes, begin with a new
/// one.
class Workspace {
 public:
  Workspace();
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;
  /// Switches the step guard off, or on again: to measure what it costs, for nothing else.
  void setGuard(bool on);
  /// Every step from now on writes into `log` what pressed on what; null: nothing is kept. It costs
  /// nothing then, and never changes the state.
  void keepContacts(ContactLog* log);
  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// Moves `state` by model.solver.step. Deterministic: same arguments, same bits.
StepReport step(const Model& model, const Inputs& inputs, Workspace& workspace, State& state);

}  // namespace ragdoll
