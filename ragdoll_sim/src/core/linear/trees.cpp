#include "ragdoll_sim/core/trees.h"

#include "core/linear/tree_build.h"

namespace ragdoll {

std::vector<TreeFinding> findTrees(const Model& model) {
  std::vector<TreeFinding> findings;
  for (const System& system : model.systems) {
    const Skeleton& skeleton = model.skeletons[system.skeleton];
    const Tree tree = buildTree(skeleton, system.pins);
    findings.push_back(
        {skeleton.name, static_cast<int>(system.pins.size()), tree.size, tree.why_not});
  }
  return findings;
}

std::string describe(const TreeFinding& finding) {
  std::string text = finding.model;
  if (finding.pins > 0)
    text += " with " + std::to_string(finding.pins) + (finding.pins == 1 ? " pin" : " pins");
  if (!finding.why_not.empty()) return text + ": no tree (" + finding.why_not + ")";
  return text + ": a tree of " + std::to_string(finding.coordinates) + " coordinates";
}

}  // namespace ragdoll
