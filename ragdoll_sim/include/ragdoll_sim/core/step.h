// One step of the world. The single entry for every method: reads as a table of contents.
#pragma once

#include <cstdint>
#include <memory>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// What a step did that a user may want to know. Nothing is mended silently.
struct StepReport {
  int contacts = 0;    ///< contact points that pressed
  int substeps = 1;    ///< most substeps that any ragdoll took
  int guarded = 0;     ///< ragdolls for which the step guard changed the method or the step
  int limited = 0;     ///< ragdolls whose energy was limited: contact, limit's blow, implicit step
  int implicit = 0;    ///< implicit steps that the guard took in place of explicit ones
  int rigid = 0;       ///< motions with the joints frozen, where even implicit steps failed
  int joining = 0;     ///< ragdolls whose sticks were drawn towards their lengths from far
  int unresolved = 0;  ///< ragdolls whose constraints did not converge
  int fast_fallbacks = 0;  ///< method fast: ragdolls that took the step by shake
};

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
