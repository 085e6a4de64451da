// An island's motion by `method: rk` through limits and contacts: pieces in one mode each, between
// events that are located in time. docs/equations.md#event-driven-rk.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Whether the scene asks for that. Within a tolerance parts are halved and compared instead, which
/// takes leapfrog's order.
bool goesThroughEvents(const StepContext& step);

/// Moves the bodies over h. contacts: that press at the end. False: what they meet is not for this
/// (moving, deep overlaps, sleepers), a mode is not unique, or events crowd; nothing is moved then.
bool moveThroughEvents(Island& island, double h, int& contacts);

}  // namespace ragdoll
