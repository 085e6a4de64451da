// Which mode (mode.h) a body is in at an instant: what touches, impacts of what approaches, and
// what then presses, sticks and slips. docs/equations.md#event-driven-rk.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// The mode at mode.start; impacts first. pressed: what pressed in the last step may be a little
/// off. False: it is not unique.
bool settleMode(Island& island, bool pressed);

}  // namespace ragdoll
