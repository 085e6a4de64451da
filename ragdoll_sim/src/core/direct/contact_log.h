// Writes down what contacts gave in a trial, for who asks (Workspace::keepContacts): the impulses
// of both stages that velocities are made of. Trials that are taken back are crossed out.
#pragma once

#include "core/direct/island.h"
#include "ragdoll_sim/core/contact_log.h"

namespace ragdoll {

/// The position stage's, as its rows (leapfrog: of the motion's start, else of its end) and s.total
/// stand: [kg m] over h.
void logPositions(Island& island, double h, bool leapfrog);

struct LoggedStage {
  bool impact = false;  ///< rates are those of an approach
  double h = 0;         ///< [s] of the motion before it
};

/// Of one solution of the velocity stage: p [N s]. rates: before it [m/s].
void logVelocities(Island& island, const RowValues& p, const RowValues& rates,
                   const LoggedStage& at);

struct LoggedImpact {
  Vec3 impulse = Vec3::Zero();  ///< [N s]
  double approach = 0;          ///< [m/s]
  double answer = 0;            ///< [1/kg] to a push along the normal
  double peak = 0;              ///< [N] of what gives way
  Vec3 back = Vec3::Zero();     ///< [m] from where it is to where it pressed in the mean
  Vec3 turn = Vec3::Zero();     ///< from the normal to the mean one
};

/// [m] of the first body's surface at x, coordinates as of a mode (mode.h).
Vec3 pointOf(const Island& island, const Contact& contact, const double* x);

/// Of a contact at x, v (coordinates as of a mode, mode.h): what one impact, or a smooth motion,
/// gave.
void logImpulse(const Island& island, const Contact& contact, const LoggedImpact& impact,
                const double* x, const double* v);

/// Whether anyone asks.
bool isLogged(const Island& island);

/// How much there is; and back to it.
std::size_t logSize(const Island& island);
void cutLog(Island& island, std::size_t size);

}  // namespace ragdoll
