// Damping of a body's inner motion: limbs stop swinging, the body as a whole is not held back.
//
// Velocities are drawn towards those of the rigid motion with the same momentum and angular
// momentum (about its pin, if it has one), v <- v_rigid + (v - v_rigid) exp(-c h), as in
// [Mueller2007, sec. 3.5]. Linear and angular momentum of a free body do not change; sticks stay
// satisfied.
#pragma once

#include <vector>

#include "ragdoll_sim/core/types.h"

namespace ragdoll {

/// x, v: 3 x n of one body; M: [kg] n x n; pins: its pinned particles; keep: exp(-c h) in (0, 1].
void dampInnerMotion(const Eigen::MatrixXd& M, const std::vector<int>& pins, double keep,
                     const Eigen::Ref<const Points>& x, Eigen::Ref<Points> v);

}  // namespace ragdoll
