// Who takes steps in the direct method's place, where it can: a faster method (fast/).
#pragma once

#include <vector>

#include "core/direct/outcome.h"
#include "core/direct/step_context.h"

namespace ragdoll {

class Stepper {
 public:
  virtual ~Stepper() = default;

  /// Moves bodies that have nothing to do with each other by the step, and fills outcomes (of all
  /// ragdolls, by index). What it leaves stays where it is, and goes to `left`.
  virtual void stepApart(const StepContext& context, const std::vector<int>& bodies,
                         std::vector<Outcome*>& outcomes, std::vector<int>& left) = 0;

  /// The same of bodies that take the step together, beside sleepers, on the thread of the context.
  /// False: it leaves them.
  virtual bool stepTogether(const StepContext& context, const std::vector<int>& bodies,
                            const std::vector<int>& sleepers, Outcome& outcome) = 0;

  /// [m] What may overlap by less touches: it does not bring bodies together that have gone apart.
  virtual double overlap() const = 0;
};

}  // namespace ragdoll
