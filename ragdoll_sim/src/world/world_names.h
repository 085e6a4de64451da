// Names of a world's particles.
#pragma once

#include <string>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// "ragdoll/particle" of a particle of the world.
std::string particleName(const Model& model, int particle);

/// The one particle that `body` names. Throws Error.
BodyRef findParticle(const Model& model, const std::string& body);

}  // namespace ragdoll
