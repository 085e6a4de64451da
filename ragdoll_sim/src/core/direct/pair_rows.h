// The rows of an island: each body's own, and those of contacts between bodies beside them.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// As those of a body (rows.h), for all together; gaps and first impulses go to island.s.b and .p.
void buildRows(Island& island, double h, bool leapfrog);
void evaluateGaps(Island& island, double h);
bool soften(Island& island, double h, bool leapfrog);
/// Whether a row is violated, or a spring presses at the motion's start: it does until it is let
/// go.
bool anyCloses(const Island& island);
void warmStart(Island& island, double h);

/// Adds a contact's rows to both bodies' complements and to the joint rows; returns the first.
/// smooth: without its friction.
int addPairRows(Island& island, const Contact& contact, int source, bool smooth = false);

/// pairs.cache <- what bodies press on each other with now.
void rememberPairs(Island& island, double h);

/// [m] the worst among the pairs' rows.
double worstPairResidual(const Island& island, bool closed);

}  // namespace ragdoll
