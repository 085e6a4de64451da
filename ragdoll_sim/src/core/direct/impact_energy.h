// Energy in an impact. Newton's restitution with Coulomb's friction may give some where a body is
// hit off its middle [Stronge1990]: it is taken out at once, of those that gained it. What flies by
// keeps its motion, and what another impact of the same substep lost does not make up for it.
#pragma once

#include <algorithm>
#include <vector>

#include "core/direct/constants.h"
#include "core/direct/island.h"

namespace ragdoll {

/// Whether what moves obstacles or pins may give energy to one of the bodies.
inline bool isDriven(const std::vector<Body*>& bodies) {
  return std::any_of(bodies.begin(), bodies.end(), [](const Body* body) { return body->driven; });
}

/// [J] What bodies that an impact pressed on each other gained in it; 0: no more than rounding.
/// before: kinetic energies [J] of all bodies of the island; energyOf(body): now.
template <class EnergyOf>
double impactGain(const Island& island, const std::vector<Body*>& bodies,
                  const std::vector<double>& before, const EnergyOf& energyOf) {
  double energy = 0, gain = 0;
  for (Body* body : bodies) {
    const double had = before[island.placeOf(body->index)];
    energy += had;
    gain += energyOf(*body) - had;
  }
  return gain > kLeastGain * energy ? gain : 0;
}

}  // namespace ragdoll
