// A moment of a world as bytes: everything that a run needs to go on to the same bits, restored
// into a world of the same scene.
//
// Layout: magic, version, fingerprint of what the scene fixes (Model without what may change while
// it runs), then gravity, solver, pins, pokes and State, then FNV-1a 64 of all before. Numbers as
// they lie in memory: for the same kind of machine and the same version, not an archive.
#pragma once

#include <cstdint>
#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// What a snapshot holds.
struct Moment {
  State state;
  std::vector<Poke> pokes;  ///< acting and to come
  std::vector<Pin> pins;    ///< as they are now, attached ones included
  Vec3 gravity = Vec3::Zero();
  SolverSpec solver;
};

/// Of names, rest poses, masses, sticks, joints, obstacles and collision settings.
std::uint64_t fingerprint(const Model& model);

std::vector<std::uint8_t> toBytes(const Model& model, const Moment& moment);

/// Throws Error unless step() can go on from it: sizes, indices, names, finite numbers.
void checkFits(const Model& model, const Moment& moment);

/// Throws Error that says what the bytes are instead: no snapshot, damaged, of another version or
/// of another scene.
Moment fromBytes(const Model& model, const std::vector<std::uint8_t>& bytes);

}  // namespace ragdoll
