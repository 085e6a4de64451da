// What a state shows that a step does not tell.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

constexpr double kDeepOverlap = 0.02;  ///< [m] deeper than any preset lets a body sink in

/// "ragdoll is 6 cm inside box_1": the deepest place of each body in each obstacle that is deeper
/// than kDeepOverlap. Obstacles are named by their type and number in the scene, from 0.
std::vector<std::string> deepOverlaps(const Model& model, const State& state);

/// Contacts of sleeping bodies, which no step counts: with obstacles, themselves and each other.
int contactsOfSleepers(const Model& model, const State& state);

/// [kg] of a skeleton's named particles: the row sums of its mass matrix. They add up to the mass,
/// and weight positions and velocities to the centre of mass and the momentum. What the unnamed
/// particle of a flat group carries is shared by the group's own, so that of a centre of mass off
/// the plane its foot in the plane is told.
Eigen::VectorXd pointMasses(const Skeleton& skeleton);

}  // namespace ragdoll
