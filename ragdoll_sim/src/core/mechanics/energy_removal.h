// Takes energy out of the motion of bodies.
//
// Contact only takes energy. Where bodies that press on something or on each other end a substep
// with more than they had plus the work of gravity and pokes, the contact solution was wrong: the
// surplus is taken out of the motion within the bodies, then out of their motion against each
// other, both of which leave momentum and angular momentum; or, where something holds them, out of
// all of it.
#pragma once

#include <vector>

#include "core/mechanics/energy_gain.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll {

struct RemovalScratch {
  Points before;
  Points x, v;  ///< for who takes energy out elsewhere than in the state
  std::vector<EnergyScratch> energy;  ///< per skeleton, so that buffers keep their sizes
};

/// Gives what is in it its size.
void makeRoom(const Model& model, RemovalScratch& scratch);

/// Takes `gain` [J] out of the motion of these bodies, one or more. held: something that takes
/// momentum, other than these bodies, pressed on one of them or pins it. Returns what is left of
/// the gain [J]: there may be less motion than it, and where nothing holds the bodies the momentum
/// of their common rigid motion is nobody's to take. x, v: columns as the state's; those of other
/// bodies are left alone.
double takeEnergyOut(const Model& model, const std::vector<int>& bodies, bool held, double gain,
                     Points& x, Points& v, RemovalScratch& scratch);

}  // namespace ragdoll
