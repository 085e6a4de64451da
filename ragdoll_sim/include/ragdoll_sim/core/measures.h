// Numbers about a state that tests, metrics and tools report. None of them is computed by a step.
#pragma once

#include <cstdint>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

double kineticEnergy(const Model& model, const State& state);  ///< [J] with the full mass matrix
double potentialEnergy(const Model& model,
                       const State& state);  ///< [J] of gravity, 0 at the origin
double springEnergy(const Model& model,
                    const State& state);  ///< [J] in contacts that give way, also between bodies
Vec3 centreOfMass(const Model& model, const State& state, int ragdoll);  ///< [m]
Vec3 momentum(const Model& model, const State& state);                   ///< [kg m/s]
Vec3 angularMomentum(const Model& model, const State& state);  ///< [kg m^2/s] about the origin
double maxStickError(const Model& model, const State& state);  ///< relative: max |len / rest - 1|
double maxPenetration(const Model& model,
                      const State& state);  ///< [m] of particle spheres in obstacles, >= 0
/// [m] of sticks, as capsules between their ends' spheres, in obstacles, >= 0; at planes an end is
/// the deepest place, so these count as particles.
double maxStickPenetration(const Model& model, const State& state);
double maxLimitViolation(const Model& model, const State& state);  ///< [rad], >= 0
std::uint64_t hash(const State& state);  ///< FNV-1a 64 over the bytes of positions, then velocities

}  // namespace ragdoll
