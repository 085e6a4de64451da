// A lone body's motion by `method: rk` through limits and contacts: pieces in one mode each, between
// events that are located in time. docs/equations.md#event-driven-rk.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// Moves a lone body over h. contacts: that press at the end. False: what it meets is not for this
/// (moving, deep overlaps, other bodies), a mode is not unique, or events crowd; nothing is
/// moved then.
bool moveThroughEvents(Island& island, double h, int& contacts);

}  // namespace ragdoll
