// A push of the particle of particles(), and steps that it acts in.
#pragma once

#include "particles.h"
#include "ragdoll_sim/world/world.h"

namespace ragdoll::test {

/// Along x [N], from `start` on for `duration` [s].
inline Poke pokeOf(const ragdoll::World& world, double start, double duration, double force) {
  Poke poke;
  poke.body_name = "ragdoll/p";
  poke.body = findBody(*world.model(), poke.body_name);
  poke.start = start;
  poke.duration = duration;
  poke.force = Vec3(force, 0, 0);
  return poke;
}

inline void advance(ragdoll::World& world, int steps) {
  for (int i = 0; i < steps; ++i) world.advance();
}

}  // namespace ragdoll::test
