#include "core/direct/mode_energy.h"

#include <numeric>

#include "core/direct/constants.h"
#include "core/direct/group_motion.h"

namespace ragdoll {
namespace {

double kineticEnergyAt(const Island& island, int k, const ModePoint& point) {
  Body& body = *island.bodies[k];
  const double* v = point.v.data() + island.s.mode.offset[k];
  return kineticEnergy(*body.rows, Eigen::Map<const Points>(v, 3, body.n), body.energy);
}

/// Whether the impact pressed the body on what is no body that moves, or a pin holds it.
bool isHeld(const Island& island, const ModeVector& p, int k) {
  const Mode& mode = island.s.mode;
  if (!island.bodies[k]->pinned->pins.empty()) return true;
  for (std::size_t i = 0; i < mode.rows.size(); ++i)
    if (mode.first[i] >= 0 && mode.rows[i].body == k && mode.rows[i].obstacle >= 0 &&
        mode.rows[i].isContact() && p[mode.first[i]] > 0)
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
  for (const Body* body : bodies)
    coordinates(body, point.v) = s.v.middleCols(body->first, body->n);
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
  group_of.resize(island.bodies.size());
  std::iota(group_of.begin(), group_of.end(), 0);
  for (std::size_t i = 0; i < mode.rows.size(); ++i)
    if (mode.rows[i].isShared() && mode.first[i] >= 0 && p[mode.first[i]] > 0)
      joinGroups(mode.rows[i].body, mode.rows[i].other, group_of);
  for (int first = 0; first < static_cast<int>(group_of.size()); ++first) {
    double energy = 0, gain = 0;
    bool held = false;
    for (int k = first; k < static_cast<int>(group_of.size()); ++k) {
      if (group_of[k] != first) continue;
      energy += before[k];
      gain += kineticEnergyAt(island, k, point) - before[k];
      held = held || isHeld(island, p, k);
    }
    if (gain > kLeastGain * energy)
      takeOut(island, membersOf(island, group_of, first), held, gain, point);
  }
}

}  // namespace ragdoll
