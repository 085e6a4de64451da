// A wrench on a frame as pokes on what the frame belongs to.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/world/world.h"

namespace ragdoll {

/// force [N] and torque [N m] in the frame's own axes. The force acts on the particle of the frame
/// (on a root frame: shared by its particles), the torque on the segment that turns with it, as the
/// smallest forces on its particles. One poke per particle, so that each can be told and replayed
/// by name; none if both are zero. Throws Error that lists the frames.
std::vector<Poke> wrenchPokes(const World& world, const std::string& frame, const Vec3& force,
                              const Vec3& torque);

}  // namespace ragdoll
