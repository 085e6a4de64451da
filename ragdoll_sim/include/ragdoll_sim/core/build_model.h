// From names to indices to constants: a scene becomes a model. What a run starts from: start_state.h.
#pragma once

#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/scene.h"

namespace ragdoll {

/// Checks the scene and resolves it. Throws Error; what is only doubtful goes to Model::warnings.
Model buildModel(const Scene& scene);

/// Recomputes the systems after a change of pins (attach, detach). Particles not pinned stay free.
void setPins(Model& model, const std::vector<Pin>& pins);

}  // namespace ragdoll
