// The step guard's last resort: the joints are frozen, which cannot fail.
#pragma once

#include "core/direct/island.h"
#include "ragdoll_sim/core/step_report.h"

namespace ragdoll {

/// What a lone body would do over h with its joints frozen, as far as the first touch; then it
/// stands. Whether it is stopped, so that it gains no energy.
bool moveRigidly(Island& island, double h, StepReport& report);

}  // namespace ragdoll
