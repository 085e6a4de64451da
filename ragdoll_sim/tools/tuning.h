// Finds the cheapest configuration for an error, or the most accurate one for a cost: first among
// all families at steps that differ by factors of two, then in between.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/scene.h"
#include "survey.h"

namespace ragdoll::lab {

/// What is wanted. Exactly one of the two is > 0.
struct Target {
  double error = 0;   ///< [m]
  double budget = 0;  ///< [s] of CPU time per simulated second
};

/// The scene begun otherwise, with what would have happened.
struct OtherStart {
  Model model;
  Reference reference;
};

/// From as many other starts, by seeds 1, 2, ..., as sure as the target needs.
std::vector<OtherStart> otherStarts(const Scene& scene, int count, const Target& target,
                                    const SurveyOptions& options, Progress& progress);

struct Choice {
  Measurement measurement;
  int others = 0;  ///< starts
  bool met = false;
  double horizon = 0;  ///< [s]
  Reference reference;
};

/// By the error to be expected of any start: of other starts and the scene's own three times the
/// largest (docs/trade_tables.md says how many more stay within it); without others the scene's
/// own. `options` are completed ones.
Choice tune(const Model& model, const Target& target, const SurveyOptions& options,
            const std::vector<OtherStart>& others, Progress& progress);

/// The section `solver:` of a scene, with what was measured as comments.
std::string toText(const Choice& choice, const Target& target, const std::string& scene);

}  // namespace ragdoll::lab
