// How two surfaces give way together: springs in series, dampers likewise.
#pragma once

#include <cstddef>
#include <vector>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Of springs in series, dampers likewise; what is rigid counts for nothing.
Compliance inSeries(const Compliance& a, const Compliance& b);

/// How one of a ragdoll's regions gives way, Skeleton::particle_contact, stick_contact or
/// capsule_contact; rigid, unless the scene switches that on.
Compliance giveOf(const Ragdoll& r, const std::vector<Compliance>& regions, std::size_t index);

/// Of an obstacle against one of them.
Compliance giveOf(const Model& model, const Obstacle& obstacle, const Ragdoll& r,
                  const std::vector<Compliance>& regions, std::size_t index);

/// Whether a contact with that gap [m] at the start of a motion touches there and so all along: a
/// rigid one at rest or sliding, a spring at any depth.
bool touchesAtStart(const Compliance& give, double start);

}  // namespace ragdoll
