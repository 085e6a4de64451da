// Complementarity (mode_solve.h) by Newton's method on what a projection changes [Alart1991]. All
// rows give way a little, so that forces are unique where rows depend on each other: as of springs,
// that share a load.
#pragma once

#include "core/direct/mode_equalities.h"

namespace ragdoll {

/// p <- near forces that agree with the inequalities. False: none were found.
bool approachComplementarity(const ModeMatrix& A, const ModeVector& b,
                             const std::vector<ModeBlock>& blocks, ModeVector& p);

}  // namespace ragdoll
