// System -> FastBody.
#pragma once

#include "core/fast/body.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll::fast {

FastBody buildBody(const Model& model, const System& system);

}  // namespace ragdoll::fast
