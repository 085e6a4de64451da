// Finds the cheapest configuration for an error, or the most accurate one for a cost: first among
// all families at steps that differ by factors of two, then in between.
#pragma once

#include <string>

#include "survey.h"

namespace ragdoll::lab {

/// What is wanted. Exactly one of the two is > 0.
struct Target {
  double error = 0;   ///< [m]
  double budget = 0;  ///< [s] of CPU time per simulated second
};

struct Choice {
  Measurement measurement;
  bool met = false;
  double horizon = 0;  ///< [s]
  Reference reference;
};

/// `options` are completed ones.
Choice tune(const Model& model, const Target& target, const SurveyOptions& options,
            Progress& progress);

/// The section `solver:` of a scene, with what was measured as comments.
std::string toText(const Choice& choice, const Target& target, const std::string& scene);

}  // namespace ragdoll::lab
