// How long the parts of a step are, so that their errors together keep to the tolerance: error per
// unit step, [Hairer1993, sec. II.4], and what is left of the step's whole allowance for what
// happens at one time, as an impact does. A part whose error is too large is to be taken back and
// done again, shorter; one that cannot keep to the tolerance stands, and is told
// (docs/equations.md#tolerance).
#pragma once

#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

class ErrorControl {
 public:
  /// tolerance: [m/s]; next: [s] the part to try first, at most h; kept for the step that follows.
  ErrorControl(double h, double tolerance, double& next);

  bool done() const;
  double left() const { return left_; }  ///< [s] of the step
  double part() const { return part_; }  ///< [s] to be taken next,
  double from() const;                   ///< [s] from the step's start on
  double allowed(int order) const;       ///< [m] that it may err by; of order: as accepts()

  /// What is left of the step was taken by a method that keeps to the tolerance itself. error: [m]
  void takeRest(double error);

  /// Whether a part may stand whose error [m] falls with its length to the power of order + 1.
  bool accepts(double error, int order);

  void tell(int bodies, StepReport& report) const;

 private:
  /// Whether shorter parts have less error per second, as those of a smooth motion have.
  bool helps(double rate, int order);
  void choosePart();

  const double h_, tolerance_, shortest_;
  double& next_;
  double left_, part_ = 0;
  double made_ = 0, spent_ = 0;  ///< [m] errors of what stands; what that is of the allowance
  double other_rate_ = 0, other_part_ = 0;  ///< of the last one that was not kept; 0: none
  int in_vain_ = 0;                         ///< of these one after the other that did not help
  int taken_ = 0;
  bool last_kept_ = true;  ///< the last part that stands
  bool missed_ = false;
};

}  // namespace ragdoll
