// Which of a few rows press, stick and slip: complementarity of forces (or impulses) p and w = b +
// A p,
//   p_n >= 0, w_n >= 0, p_n w_n = 0;   |p_t| <= mu p_n;   p_t against w_t where it is less.
// Newton's method (mode_newton.h) guesses, equalities are solved (mode_equalities.h), and what they
// contradict is changed, one row at a time.
#pragma once

#include <vector>

#include "core/direct/mode_equalities.h"

namespace ragdoll {

/// Of impulses: what each row alone would take, the largest.
double impulseScale(const ModeMatrix& A, const ModeVector& b);

/// Finds what presses, sticks and slips. Scale: of forces, below 1e-9 of which they are none.
/// False: no unique answer was found.
bool solveComplementarity(const ModeMatrix& A, const ModeVector& b, double scale,
                          std::vector<ModeBlock>& blocks, ModeVector& p);

}  // namespace ragdoll
