// How long the parts of a step are, so that the error of each keeps to the tolerance: error per unit
// step, [Hairer1993, sec. II.4]. A part whose error is too large is to be taken back and done again,
// shorter; one that cannot keep to the tolerance stands, and is told (docs/equations.md#tolerance).
#pragma once

#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

class ErrorControl {
 public:
  /// tolerance: [m/s]; next: [s] the part to try first, at most h; kept for the step that follows.
  ErrorControl(double h, double tolerance, double& next);

  bool done() const;
  double part() const { return part_; }  ///< [s] to be taken next,
  double from() const;                   ///< [s] from the step's start on

  /// Whether a part may stand whose error [m] falls with its length to the power of order + 1.
  bool accepts(double error, int order);

  void tell(int bodies, StepReport& report) const;

 private:
  /// Whether a shorter part has less error per second, as that of a smooth motion has.
  bool helps(double rate, int order);
  void choosePart();

  const double h_, tolerance_;
  double& next_;
  double left_, part_ = 0;
  double rejected_rate_ = 0, rejected_part_ = 0;  ///< of the last try; 0: none
  double first_try_ = 0;                          ///< [s] from where what is past goes on; 0: none
  int in_vain_ = 0;                               ///< tries one after the other that did not help
  double largest_rate_ = 0;
  int taken_ = 0;
  bool missed_ = false;
};

}  // namespace ragdoll
