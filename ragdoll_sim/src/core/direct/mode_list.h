// Lists the rows (mode_rows.h) that a motion through contact may meet.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// [m] How far kReach motions of the fastest body over h go: in an impact its speed is another's.
double reachOf(const Island& island, double h);

/// Lists in the island's mode all that a motion may meet in which nothing goes farther than `reach`
/// [m], and what it cannot be: false where something is deep in what is rigid, or moves. Lays out
/// the bodies' coordinates.
bool listModeRows(Island& island, double reach);

}  // namespace ragdoll
