// Virtual sensors of a scene, resolved.
#pragma once

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Adds the sensor to the model, whose ragdolls and solver are there. Throws Error.
void addSensor(const SensorSpec& spec, Model& model);

}  // namespace ragdoll
