// Named settings of the solver: a `preset` in a scene is one of these, and every other key of its
// `solver:` section changes a single knob of it.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/scene.h"

namespace ragdoll {

/// thesis, fast, draft, balanced, precise, reference: from the source's own to the most accurate.
const std::vector<std::string>& presetNames();

const std::vector<std::string>& methodNames();      ///< in the order of Method
const std::vector<std::string>& integratorNames();  ///< in the order of Integrator

/// Order of the error of a preset, such as "10 mm": how far particles are from the exact motion
/// (RMS) after 0.1 s of contact, the median of the scenes in docs/trade.md that have some. Empty if
/// knobs differ from those of the preset.
std::string errorClass(const SolverSpec& solver);

/// Throws Error that lists the names.
SolverSpec preset(const std::string& name);

}  // namespace ragdoll
