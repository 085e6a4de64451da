// What touched, as messages.
#pragma once

#include <ragdoll_msgs/ContactState.h>
#include <ragdoll_msgs/Impact.h>

#include "ragdoll_sim/world/contacts.h"

namespace ragdoll {

/// interval: [s] that the touch is of, > 0.
ragdoll_msgs::ContactState toContactState(const Model& model, const Touch& touch, double interval);

/// Without a header.
ragdoll_msgs::Impact toImpact(const Model& model, const ImpactReport& impact);

}  // namespace ragdoll
