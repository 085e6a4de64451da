// One step of the world. The single entry for every method: reads as a table of contents.
#pragma once

#include <memory>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

/// Scratch memory of one model, sized once; a step allocates nothing after the first few. Where the
/// model changes, begin with a new one.
class Workspace {
 public:
  Workspace();
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;
  /// Switches the step guard off, or on again: to measure what it costs, for nothing else.
  void setGuard(bool on);
  struct Impl;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// Moves `state` by model.solver.step. Deterministic: same arguments, same bits.
StepReport step(const Model& model, const Inputs& inputs, Workspace& workspace, State& state);

}  // namespace ragdoll
