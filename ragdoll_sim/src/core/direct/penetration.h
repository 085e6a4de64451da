// How much of an overlap a motion may leave: what is found overlapping opens at a bounded speed,
// so that nothing is shot out of what it is in. Pure functions.
#pragma once

#include "core/contact/contact.h"
#include "core/direct/constraint_set.h"
#include "ragdoll_sim/core/limits.h"

namespace ragdoll {

/// A motion over `over` [s], a part of a substep of `substep`, itself a part of a step of `step`.
struct MotionSpan {
  double over = 0, substep = 0, step = 0;  ///< [s]
};

/// [m] Of the overlap of two capsules: it shrinks evenly. Ends that lie behind the contact's plane
/// at the start, though they do not overlap there, come out over the whole step.
double allowedPenetration(const Contact& pair, double over, double step);

/// [m] The gap at the motion's start, where the plane of its end says `plane`: what touches all
/// along has not sunk in, nor is it coming, where that has turned.
double gapBefore(const Contact& contact, double plane);

/// [m/s] at which an overlap with this obstacle opens.
double recoverySpeed(const Contact& contact);

/// [m] The plane's offset at the motion's end, with nothing left of an overlap.
double movedOffset(const Contact& contact, const MotionSpan& span);

/// [m] The plane's offset by which a contact is solved.
double allowedOffset(const Contact& contact, const MotionSpan& span);

/// [rad] The same of a hard limit: by how much it may stay violated.
double allowedViolation(const LimitRow& limit, const MotionSpan& span, OverlapPolicy policy);

/// Whether the policy lets the contact's overlap be.
bool isIgnored(const Contact& contact, OverlapPolicy policy);

}  // namespace ragdoll
