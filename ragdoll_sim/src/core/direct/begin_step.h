// What a step does to its bodies before they move.
#pragma once

#include "core/direct/island.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

/// Pins, lengths, forces, and the impulses of the last step.
void beginStep(Island& island, StepReport& report);
void beginStep(Body& body, StepReport& report);

/// Puts rigid groups back into the shape that their frames can have; or their velocities alone.
void makeAffine(Body& body);
void makeVelocitiesAffine(Body& body);

}  // namespace ragdoll
