// Which bodies are trees of rods and rigid groups: what the method `fast` steps in its packs.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// What a model is with some of its particles pinned.
struct TreeFinding {
  std::string model;    ///< its name
  int pins = 0;         ///< pinned particles
  int coordinates = 0;  ///< of the tree
  std::string why_not;  ///< what makes it no tree; empty: it is one
};

/// One for each model and set of pins that the scene's bodies have.
std::vector<TreeFinding> findTrees(const Model& model);

/// "human: a tree of 25 coordinates", "human with 2 pins: no tree (two particles are pinned)"
std::string describe(const TreeFinding& finding);

}  // namespace ragdoll
