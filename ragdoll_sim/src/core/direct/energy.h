// What a trial gained more than gravity, pokes, soft limits and what drives the bodies can have
// given them, and how that is taken out again: contact only takes energy
// (docs/equations.md#energy).
#pragma once

#include "core/direct/island.h"

namespace ragdoll {

/// [J] of a body.
double kineticEnergy(Body& body);
/// [J] What gains are compared with: kinetic energy, and a fall of 1 m, by the bodies' size.
double swingScale(Island& island);

/// [J] by how much the body gained more in a trial that took so long [s] than what acts on it,
/// driven at `drive` [m/s], can have given it.
double gainedEnergy(Body& body, double took, double drive);
/// The same of some bodies of an island, with what is between them; and of all.
double gainedEnergy(Island& island, const std::vector<Body*>& bodies, double took, double drive);
double gainedEnergy(Island& island, double took, double drive);
/// [m/s] of what moves the bodies from outside: pins, obstacles that they may touch.
double driveSpeed(const Island& island);

/// Whether the trial met nothing but limits that pressed all the while, and no pin moves: the
/// energy stays but for leapfrog's swing, which is not to be taken out.
bool isSmooth(Island& island);

/// Whether a trial that gained so much is to be done again at half.
bool isLargeGain(Island& island, double gain, bool smooth);

/// [J] A trial that gains more has gone astray: more than the kinetic energy, and than would bring
/// the bodies from rest to a speed that no overlap opens at.
double wildGain(Island& island);

/// Whether something takes the momentum of some bodies of an island: a pin, an obstacle, a sleeper.
/// Before the motion's impact: not what it was cut short for.
enum class Held { kBeforeImpact, kAfterImpact };
bool isHeld(const Island& island, const std::vector<Body*>& bodies, Held when = Held::kAfterImpact);

/// Takes a gain out of the motion of some bodies of an island (energy_removal.h); returns what is
/// left of it. held: isHeld. island.s.removal.before: velocities as they were (columns as the
/// state's).
double takeEnergyOut(Island& island, const std::vector<Body*>& bodies, bool held, double gain);
/// The same of all, after a trial that took so long [s]. Whether all of it is out, or nearly.
bool removeEnergy(Island& island, double gain, double took);

}  // namespace ragdoll
