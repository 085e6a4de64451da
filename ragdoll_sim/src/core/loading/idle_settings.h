// Settings of the solver that do nothing in a scene.
#pragma once

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Appends to Model::warnings those of a model that is complete, and why.
void warnOfIdleSettings(Model& model);

}  // namespace ragdoll
