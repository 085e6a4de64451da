// Energy limiter of bodies that touch each other.
//
// Contact only takes energy. Where bodies that pressed on each other end a substep with more than
// they had plus the work of gravity and pokes, the contact solution was wrong: the surplus is taken
// out of the motion within the bodies, then out of their motion against each other, or, where
// something holds them, out of all of it.
#pragma once

#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

struct GroupScratch {
  Points all, pushed;
};

/// Takes `rise` [J] out of the motion of these bodies; held: something else, that takes momentum,
/// pressed on one of them. If not, no more than their common momentum allows.
void takeOutOfGroup(const Model& model, const std::vector<int>& bodies, bool held, double rise,
                    State& state, GroupScratch& scratch);

}  // namespace ragdoll
