// Energy limiter of bodies that touch each other, direct methods.
//
// Contact only takes energy. Where bodies that pressed on each other end a step with more than they
// had plus the work of gravity and pokes, the contact solution was wrong: the surplus is taken out
// of the motion within the bodies, then out of their motion against each other. Their common
// momentum does not change.
#pragma once

#include <vector>

#include "ragdoll_sim/core/contact.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// contacts: between bodies that met in the step; x0, v0: its start (3 x N); force: of
/// pokes [N] (3 x N), null: none. Returns how many bodies lost energy.
int limitPairEnergy(const Model& model, const std::vector<Contact>& contacts, const Points& x0,
                    const Points& v0, const Points* force, State& state);

}  // namespace ragdoll
