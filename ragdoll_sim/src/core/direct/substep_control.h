// Which method takes the next substep, how long it is, and what follows when it fails: the step
// guard (docs/equations.md#guard).
//
//   method    a failed trial is done again    down to          and then
//   explicit  at half                         h / most         implicitly, over all that is left
//   implicit  at a quarter                    h / (4 most)*    with more overlaps ignored; then
//                                                              rigidly (alone, if there are others)
//   rigid     cannot fail
//
// most: kMaxSubsteps; kMaxDriven while obstacles or pins move, which leave no solution sooner; 1
// for a squeezed body, for which smaller steps find none. *: h / most where that is less than
// kMaxSubsteps.
#pragma once

#include "core/direct/island.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

class SubstepControl {
 public:
  enum class Way { kExplicit, kImplicit, kRigid, kAlone };

  /// Over h, a part of the step or all of it.
  SubstepControl(Island& island, double h);

  bool done() const;
  Way way() const { return way_; }
  double substep() const { return cut_ > 0 ? cut_ : substep_; }  ///< [s] of the next trial
  double left() const { return left_; }                          ///< [s]
  bool guarded() const { return guarded_; }                      ///< some trial was not explicit
  bool limited() const { return limited_; }                      ///< of some, energy was taken out

  /// Whether the trial may be done again for more exactness: at half (kMaxSubsteps of them at most,
  /// 1 if squeezed; below h / most implicitly); and so that what its tension has become is halved
  /// once more.
  bool canHalve() const;
  bool canHalveTwice() const;

  /// limited: energy was taken out of it.
  void accept(double took, bool limited);
  /// After a failed trial that has been taken back.
  void retry();
  /// The next trial alone is so long [s]: something happens there in the last one, which has been
  /// taken back.
  void cut(double time) { cut_ = time; }
  void tell(StepReport& report) const;

 private:
  bool isSqueezed() const;
  int most() const;
  bool isTooShort(double substep, int pieces) const;
  /// Ignores more of what overlaps; false: nothing is left to ignore.
  bool ignoreMore();
  /// The next way, over all that is left.
  void goTo(Way way);

  Island& island_;
  const double h_;
  Way way_ = Way::kExplicit;
  double substep_, left_, cut_ = 0;
  int taken_ = 0;
  bool guarded_ = false, limited_ = false;
};

}  // namespace ragdoll
