// Skeleton + pins -> Tree.
#pragma once

#include <vector>

#include "core/linear/tree.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// pins: pinned particles. What is no tree (two pins, loops of rods) has why_not and nothing else.
Tree buildTree(const Skeleton& skeleton, const std::vector<int>& pins);

}  // namespace ragdoll
