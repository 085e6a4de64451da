// A start that keeps the joint limits.
//
// `place` puts single particles anywhere. A joint that it leaves outside its hard limits would be
// thrown back in the first step; so the body is put right at load instead, by the least motion in
// the mass metric that brings the joints back and keeps the sticks as long as they are. What is
// placed or pinned stays where it is, if it can.
#pragma once

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Corrects model.start_position of one ragdoll whose particles `placed` (of its skeleton) were
/// given; pins and systems are there. Warnings name the joints that were outside, by how much, and
/// what moved. Sticks far from their lengths are drawn in by the first steps, which no pose now can
/// answer for: then it only warns.
void correctStart(Model& model, int ragdoll, const std::vector<int>& placed);

}  // namespace ragdoll
