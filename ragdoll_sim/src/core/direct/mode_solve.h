// A few rows that press, solved exactly: forces (or impulses) p of w = b + A p with w = 0 where a
// row presses or sticks; friction of a contact that slips is tied to its normal force, p_t = -mu
// p_n s, so that the matrix is not symmetric. And which rows those are: complementarity
//   p_n >= 0, w_n >= 0, p_n w_n = 0;   |p_t| <= mu p_n;   p_t against w_t where it is less.
// Projected Gauss-Seidel [Moreau1988] guesses, equalities are solved, and what they contradict is
// changed, one row at a time. Rows that depend on others: minimum norm.
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
  bool slips = false;                              ///< it moves already: the direction is given
  Eigen::Vector2d slip = Eigen::Vector2d::Zero();  ///< unit, of the motion along the tangents
};

/// p with equalities as the blocks say; false: they contradict each other.
bool solveEqualities(const ModeMatrix& A, const ModeVector& b, const std::vector<ModeBlock>& blocks,
                     ModeVector& p);

/// Finds what presses, sticks and slips, from p on. Scale: of forces, below 1e-9 of which they are
/// none. False: no unique answer was found.
bool solveComplementarity(const ModeMatrix& A, const ModeVector& b, double scale,
                          std::vector<ModeBlock>& blocks, ModeVector& p);

}  // namespace ragdoll
