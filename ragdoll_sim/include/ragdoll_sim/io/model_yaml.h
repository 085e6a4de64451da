// Models (skeletons) from YAML. The format is the one of models/human.yaml. Only the form is
// checked here: types, ranges, unknown keys, duplicate names; what the parts mean together is for
// buildModel.
#pragma once

#include <memory>
#include <string>

#include "ragdoll_sim/core/scene.h"

namespace ragdoll {

/// Throws Error that names file, line and key.
std::shared_ptr<const SkeletonSpec> loadModel(const std::string& path);

/// `name` is what messages call the text, and the model if the text does not name itself.
std::shared_ptr<const SkeletonSpec> parseModel(const std::string& text,
                                               const std::string& name = "<text>");

}  // namespace ragdoll
