// Which contacts and limits motions may meet: of a body with obstacles and itself, and between the
// bodies of an island.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// All that the present motions over h come near to, in place of what was known.
void findCandidates(Body& body, double h);
void findCandidates(Island& island, double h);

/// Has contacts whose planes are others in a motion that is cut short to `over`, of its substep, as
/// they are then; so has what is hit.
void findContactsAnew(Body& body, double over, double substep);
void findContactsAnew(Island& island, double over, double substep);

/// Has what touches at the start as it is there: for velocities before any motion.
void placeAtStart(Island& island);

/// What may stay of overlaps, anew: motions are cut short to h of their substep.
void limitDepenetration(Body& body, double h, double substep);
void limitDepenetration(Island& island, double h, double substep);

/// Adds the limits that come nearer than the margin [rad] at the motion's end; whether there are
/// new ones.
bool addLimits(Body& body, double margin, double h, Role role);

/// Adds, as active, what motions were pushed into by what they were solved for; whether there is
/// any.
bool findMissed(Body& body, double h);
bool findMissed(Island& island, double h);

/// Makes rows of those that the solution of the others violates; whether there are any.
bool activateViolated(Body& body);
bool activateViolated(Island& island);
/// Makes rows of all that are not to be reached later.
void activateAll(Island& island);

/// Whether what overlaps at the start, by more than sound steps leave, leaves no direction to open
/// in: it presses from opposite sides, or is a body.
bool isSqueezed(const Body& body);
/// Whether a step that fails means that the overlap at its start cannot open.
inline bool hasNoWayOut(const Body& body) {
  return body.overlaps == OverlapPolicy::kResolve && isSqueezed(body);
}

}  // namespace ragdoll
