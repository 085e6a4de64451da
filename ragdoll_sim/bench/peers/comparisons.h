// What is compared; each prints its tables as Markdown.
#pragma once

#include "peer.h"

namespace ragdoll::peers {

/// Two hinged rods: error of the tip after 1 s against the Lagrangian, and cost.
void comparePendulum(const std::vector<Engine>& engines);

/// The human falling on a floor from a set of tilts: what a user sees go wrong, and cost.
void compareFall(const std::vector<Engine>& engines);

/// Many of them that fall side by side: cost of a body's step at 1/60 s, in the air and after the
/// impact.
void compareCrowd(const std::vector<Engine>& engines);

}  // namespace ragdoll::peers
