// Which contacts and limits a motion may meet.
#pragma once

#include "core/direct/body.h"

namespace ragdoll {

/// [m] of the contact's plane after the motion dx (the body's, 3 x n, columns).
double gapAt(const Body& body, const Contact& contact, const double* dx);
inline double gapAfter(const Body& body, const Contact& contact) {
  return gapAt(body, contact, body.motion.dx.data());
}
/// [m] or [m/s] of the contact's point, by the body's dx or velocities.
Vec3 motionOf(const Body& body, const Contact& contact, const double* dx);
/// [m/s] at which the gap opens now.
double openingRate(const Body& body, const Contact& contact);

/// Whether one of the same surfaces is among the first `count` contacts.
bool isKnown(const std::vector<Contact>& contacts, std::size_t count, const Contact& contact);

/// All that the present motion over h comes near to, in place of what was known.
void findCandidates(Body& body, double h);

/// Whether what touches all along an obstacle at rest, or a limb, has another plane than a motion
/// over `over` would: it is turned, or seen from the start it lies elsewhere than what touches
/// there, by more than may be left in such a part of a step, where it becomes a speed.
bool hasOtherPlane(const Body& body, const Contact& contact, double over);
bool hasOtherPlane(const Body& body, const std::vector<Contact>& contacts, double over);
/// Has the contact as it is among those that are found now, at the place nearest to its own;
/// whether it is there.
bool findAnew(const std::vector<Contact>& found, Contact& contact);
/// Has all such contacts as they are at the end of the motion over `over`, which is cut short.
void findContactsAnew(Body& body, double over);

/// What may stay of overlaps, anew: the motion is cut short to h of its substep.
void limitDepenetration(Body& body, double h, double substep);

/// Adds the limits that come nearer than the margin [rad] at the motion's end; whether there are
/// new ones.
bool addLimits(Body& body, double margin, double h, Role role);

/// Adds, as active, what a motion was pushed into by what it was solved for; whether there is any.
bool findMissed(Body& body, double h);

/// Makes rows of those that the solution of the others violates; whether there are any.
bool activateViolated(Body& body);
/// Makes rows of all that are not to be reached later.
void activateAll(Body& body);

/// Whether what overlaps at the start, by more than sound steps leave, leaves no direction to open
/// in: it presses from opposite sides, or is a body.
bool isSqueezed(const Body& body);
/// Whether a step that fails means that the overlap at its start cannot open.
inline bool hasNoWayOut(const Body& body) {
  return body.overlaps == OverlapPolicy::kResolve && isSqueezed(body);
}

}  // namespace ragdoll
