// What a skeleton with a set of pinned particles gives the solvers: Skeleton + pins -> System.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Appends to `warnings` what the checks found.
System buildSystem(const Skeleton& skeleton, int skeleton_index, const std::vector<int>& pins,
                   std::vector<std::string>& warnings);

}  // namespace ragdoll
