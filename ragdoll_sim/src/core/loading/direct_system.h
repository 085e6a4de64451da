// Constants of the direct methods for one skeleton and pin set (docs/equations.md#formulation).
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Takes the pinned particles out of W (n x n): W <- W - W_E (W_EE)^-1 W_E^T for the set E of pins,
/// so that no solver has to know about them. Returns p x n, how each pin's motion carries the
/// others.
Eigen::MatrixXd takeOutPins(const std::vector<int>& pins, Eigen::MatrixXd& W);

/// Finds sticks that no motion needs and leaves them out (a warning says which), and measures the
/// condition of what remains. Throws Error with the particles' names for a skeleton that no direct
/// method can hold.
DirectSystem buildDirectSystem(const Skeleton& skeleton, const std::vector<int>& pins,
                               std::vector<std::string>& warnings);

}  // namespace ragdoll
