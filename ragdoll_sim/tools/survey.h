// All configurations on one scene: what `trade` prints and `tune` chooses from.
#pragma once

#include <vector>

#include "measurement.h"
#include "progress.h"

namespace ragdoll::lab {

struct SurveyOptions {
  double horizon = 0;  ///< [s]; 0: 1 s, 2 s where there is something to touch
  double window = 0;   ///< [s]; 0: the horizon, 0.1 s where there is something to touch
  bool integrators = false;
  bool presets = true;
  double dearest = 0.3;  ///< [s] of CPU per simulated second; a family is not refined beyond
};

struct Survey {
  double horizon = 0;
  Reference reference;
  std::vector<Measurement> rows;  ///< families, coarse to fine, then presets
};

/// Fills horizon and window where they are 0 and checks them. Throws Error.
SurveyOptions completed(const Model& model, SurveyOptions options);

/// `options` are completed ones.
Survey survey(const Model& model, const SurveyOptions& options, Progress& progress);

}  // namespace ragdoll::lab
