// Where rows all but contradict each other, as those of a limb between two obstacles, or press
// through light bodies, projected Gauss-Seidel (schur_sweeps.h) alone would take thousands of
// sweeps: Anderson acceleration [Walker2011] of batches of them.
#pragma once

#include <vector>

#include "core/linear/anderson.h"
#include "core/linear/schur.h"

namespace ragdoll {

class SweepBatches {
 public:
  /// p: where sweeps gave up. answers: A's diagonal. sweep(p): a batch from p on; whether it
  /// settled. Returns whether one did; if not, p is as it was where it would have grown without
  /// bound.
  template <class Sweep>
  bool solve(const std::vector<SchurBlock>& blocks, const RowValues& answers, const Sweep& sweep,
             RowValues& p) {
    start_ = p;
    // Impulses in units in which all rows yield alike.
    scale_ = answers.cwiseMax(0).cwiseSqrt();
    anderson_.start();
    for (int batch = 0; batch < kBatches; ++batch) {
      scaled_ = scale_.cwiseProduct(p);
      if (sweep(p)) return true;
      swept_ = scale_.cwiseProduct(p);
      if (!anderson_.mix(scaled_, swept_, better_)) break;
      if (batch > 0 && better_.allFinite()) putAllowed(blocks, p);
    }
    if (!(scale_.cwiseProduct(p).norm() <= kMostGrowth * scale_.cwiseProduct(start_).norm()))
      p = start_;
    return false;
  }

 private:
  /// p, as allowed, from better_ over the scale; what cannot move stays.
  void putAllowed(const std::vector<SchurBlock>& blocks, RowValues& p) const;

  RowValues start_, scale_, scaled_, swept_, better_;
  Anderson anderson_;
};

}  // namespace ragdoll
