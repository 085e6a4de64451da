// An island's motion by `method: rk` through limits and contacts: pieces in one mode each, between
// events that are located in time. docs/equations.md#event-driven-rk.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Moves the bodies over h. contacts: that press at the end; error: [m] of a part of a step, by the
/// pieces' formula. False: what they meet is not for this (deep overlaps, sleepers), a mode is not
/// unique, or events crowd; nothing is moved then.
bool moveThroughEvents(Island& island, double h, int& contacts, double& error);

}  // namespace ragdoll
