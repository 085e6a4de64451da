#include "core/direct/mode_energy.h"

#include <algorithm>

#include "core/direct/group_motion.h"
#include "core/direct/impact_energy.h"

namespace ragdoll {
namespace {

double kineticEnergyAt(const Island& island, int k, const ModePoint& point) {
  Body& body = *island.bodies[k];
  const double* v = point.v.data() + island.s.mode.offset[k];
  return kineticEnergy(*body.rows, Eigen::Map<const Points>(v, 3, body.n), body.energy);
}

/// Whether the impact pressed one of the bodies on what is no body that moves, or a pin holds it.
bool isHeld(const Island& island, const ModeVector& p, const std::vector<Body*>& bodies) {
  const Mode& mode = island.s.mode;
  const auto isOf = [&](int k) {
    return std::find(bodies.begin(), bodies.end(), island.bodies[k]) != bodies.end();
  };
  for (const Body* body : bodies)
    if (!body->pinned->pins.empty()) return true;
  for (std::size_t i = 0; i < mode.rows.size(); ++i)
    if (mode.first[i] >= 0 && mode.rows[i].obstacle >= 0 && mode.rows[i].isContact() &&
        p[mode.first[i]] > 0 && isOf(mode.rows[i].body))
      return true;
  return false;
}

/// Of bodies that an impact has pressed on each other.
void takeOut(Island& island, const std::vector<Body*>& bodies, bool held, double gain,
             ModePoint& point) {
  const Mode& mode = island.s.mode;
  RemovalScratch& s = island.s.removal;
  const auto coordinates = [&](const Body* body, RowValues& of) {
    double* own = of.data() + mode.offset[island.placeOf(body->index)];
    return Eigen::Map<Points>(own, 3, body->n);
  };
  std::vector<int>& ragdolls = island.s.drained;
  ragdolls.clear();
  for (const Body* body : bodies) {
    ragdolls.push_back(body->index);
    s.x.middleCols(body->first, body->n) = coordinates(body, point.x);
    s.v.middleCols(body->first, body->n) = coordinates(body, point.v);
  }
  takeEnergyOut(island.context.model, ragdolls, held, gain, s.x, s.v, s);
  for (const Body* body : bodies) coordinates(body, point.v) = s.v.middleCols(body->first, body->n);
}

}  // namespace

void findEnergies(const Island& island, const ModePoint& point, std::vector<double>& energies) {
  energies.clear();
  for (int k = 0; k < static_cast<int>(island.bodies.size()); ++k)
    energies.push_back(kineticEnergyAt(island, k, point));
}

void takeImpactGains(Island& island, const ModeVector& p, const std::vector<double>& before,
                     ModePoint& point) {
  const Mode& mode = island.s.mode;
  std::vector<int>& group_of = island.s.group;
  startGroups(island, group_of);
  for (std::size_t i = 0; i < mode.rows.size(); ++i)
    if (mode.rows[i].isShared() && mode.first[i] >= 0 && p[mode.first[i]] > 0)
      joinGroups(mode.rows[i].body, mode.rows[i].other, group_of);
  const auto energyOf = [&](const Body& body) {
    return kineticEnergyAt(island, island.placeOf(body.index), point);
  };
  forEachGroup(island, group_of, [&](const std::vector<Body*>& bodies) {
    if (isDriven(bodies)) return;
    const double gain = impactGain(island, bodies, before, energyOf);
    if (gain > 0) takeOut(island, bodies, isHeld(island, p, bodies), gain, point);
  });
}

}  // namespace ragdoll
