// A few rows that press, solved exactly: forces (or impulses) p of w = b + A p with w = 0 where a
// row presses or sticks; friction of a contact that slips is tied to its normal force, p_t = -mu
// p_n s, so that the matrix is not symmetric. Rows that depend on others share the load.
#pragma once

#include <vector>

#include "core/direct/mode_constants.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll {

using ModeVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostModeRows, 1>;
using ModeMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostModeRows, kMostModeRows>;

/// One limit or contact among the rows of A: its first row, and two tangents after it.
struct ModeBlock {
  int row = 0;
  double friction = 0;  ///< 0: no tangents
  bool presses = false, sticks = false;
  bool given = false;  ///< the normal force is known, and its row no equality:
  double force = 0;
  bool slips = false;  ///< it moves already: the direction is given
  /// Slip is impending: it would stick, were its force not at the cone; it stands still as others
  /// hold it, and takes no more along `slip`.
  bool impending = false;
  double lean = 0;  ///< [N] of that: force across by which its direction was changed
  Eigen::Vector2d slip = Eigen::Vector2d::Zero();  ///< unit, of the motion along the tangents

  /// Along the surface, across the slip.
  Eigen::Vector2d across() const { return {-slip.y(), slip.x()}; }
};

/// What scales a block's normal row, and both of its tangents, to a unit diagonal; 0: it cannot
/// move.
double normalScale(const ModeMatrix& A, const ModeBlock& block);
double tangentScale(const ModeMatrix& A, const ModeBlock& block);

/// p with equalities as the blocks say; false: they contradict each other, by more than that share
/// of what is asked for and `left`, in the units of b.
bool solveEqualities(const ModeMatrix& A, const ModeVector& b, const std::vector<ModeBlock>& blocks,
                     ModeVector& p, double left = kContradictionLeft);

/// loads <- [N] what each block that does not press, though it is closed, would press with if
/// springs under all could pull (docs/equations.md#shared-load): if its row depends on those of
/// solution p nothing else tells that it is to press. Positive: it is. -infinity: of all others.
void findIdleLoads(const ModeMatrix& A, const std::vector<ModeBlock>& blocks, const ModeVector& p,
                   std::vector<double>& loads);

}  // namespace ragdoll
