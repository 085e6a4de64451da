// What a motion through contact begins with: where the bodies are, and a list of the rows
// (mode_rows.h) that it may meet.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// [m] How far kReach motions of the fastest body and what moves there go in h: in an impact its
/// speed is another's.
double reachOf(const Island& island, double h);

/// mode.start <- the bodies as they are; lists in the island's mode all that a motion may meet in
/// which nothing goes farther than `reach` [m]. False: something is deep in what is rigid.
bool startMode(Island& island, double reach);

}  // namespace ragdoll
