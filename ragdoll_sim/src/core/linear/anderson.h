// Anderson acceleration of a fixed-point iteration x <- g(x) [Walker2011, algorithm AA]: the next x
// is the combination of the last results whose changes g(x) - x nearly cancel.
//
// Least squares by modified Gram-Schmidt [Golub2013, sec. 5.2.8]. Allocates only where it needs
// more than ever before.
#pragma once

#include <array>

#include "core/base/growing.h"
#include "core/linear/constants.h"

namespace ragdoll {

class Anderson {
 public:
  /// Forgets what it knows.
  void start() { known_ = next_ = 0, first_ = true; }

  /// better: the x to try next, after g(before) = result. False: changes hardly differ from the
  /// last ones, so that the iteration drifts without end.
  bool mix(const RowValues& before, const RowValues& result, RowValues& better);

 private:
  /// share_ <- of the known changes, what comes nearest to change_.
  void findShares();

  RowValues change_, last_change_, last_result_, rest_;
  Growing<Eigen::MatrixXd> changes_, results_, basis_;  ///< a column for each that is known
  std::array<double, kMemory> share_{};
  int known_ = 0, next_ = 0;
  bool first_ = true;
};

}  // namespace ragdoll
