// From names to indices to constants: a scene becomes a model and the state that it starts from.
#pragma once

#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/scene.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// Checks the scene and resolves it. Throws Error; what is only doubtful goes to Model::warnings.
Model buildModel(const Scene& scene);

/// Recomputes the systems after a change of pins (attach, detach). Particles not pinned stay free.
void setPins(Model& model, const std::vector<Pin>& pins);

/// The scene's start.
State startState(const Model& model);

}  // namespace ragdoll
