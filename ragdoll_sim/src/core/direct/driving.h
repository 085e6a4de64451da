// Forces that follow the motion: pokes off their body's own point, whose spread over the particles
// depends on the pose, and damping, which depends on the velocities.
//
// Leapfrog takes a poke's force at the pose at both ends of its motion, and damps at both ends by
// half of what decays in it (Strang splitting), before the impact that a motion ends with: second
// order. rk evaluates both at each of its stages.
// docs/equations.md#damping.
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// What accelerates the body at the step's start.
void startDriving(Body& body);

/// Whether the body is accelerated by more than constant forces within its motion.
inline bool forcesFollow(const Body& body) { return body.pushed || body.damps_within; }

/// Whether a poke acts on the body, wherever.
bool isPoked(const Body& body);

/// The forces and accelerations at the pose x (3 x n); nothing where no poke follows the pose.
void driveAt(Body& body, const double* x);

/// `free` <- the acceleration without sticks at x, v (3 x n). Returns the power [W] of what is
/// counted in Body::given, damping's too.
double drive(Body& body, const double* x, const double* v, Points& free);

/// [J] Adds to Body::given what the pokes that follow the pose do over a part of the motion, 0 to
/// 1, by the forces as they are now.
void addWork(Body& body, double part);

/// Adds to velocities v (3 x n) that of a pin, the body's p-th, and what it carries along with it.
void addCarried(const Body& body, std::size_t p, const Vec3& velocity, Eigen::Ref<Points> v);
/// The same of all pins as they are in `of` (3 x n), times a share.
void addCarried(const Body& body, const Points& of, double share, Eigen::Ref<Points> v);

/// Gives pins the velocities that they had `before` (3 x n), and what they carry along.
void restorePins(Body& body, const Points& before);

/// Damps the velocities as in `time` [s]; not those of pins, and what they carry along.
void damp(Body& body, double time);
/// The same of the bodies whose damping is part of the motion.
void dampWithin(Island& island, double time);

}  // namespace ragdoll
