// The first event of a motion in a mode (mode.h), what ends it: a row closes, releases, leaves its
// place, or its slip begins or ends. Located on the dense output [Hairer1993, sec. II.6] and then
// by motions that end there. docs/equations.md#event-driven-rk.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

struct ModeEvent {
  bool any = false;
  std::size_t which = 0;  ///< row and what it does
  double share = 1;       ///< of the motion
};

/// The first event of the motion over h from mode.start to mode.end. False: no forces were found.
bool findModeEvent(Island& island, double h, ModeEvent& found);

/// Moves mode.end to that event, or to one before it: beyond an event the motion says little about
/// which comes first, so that it is looked for again in the motion that ends there. time: [s] of
/// it. False: it is not found.
bool moveToModeEvent(Island& island, double h, ModeEvent found, double& time);

}  // namespace ragdoll
