// What happens to a world besides its steps, as it is told, recorded and replayed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/types.h"
#include "ragdoll_sim/world/follow.h"

namespace ragdoll {

/// Whether one of the pokes is this one.
bool contains(const std::vector<Poke>& pokes, const Poke& poke);

using Bytes = std::vector<std::uint8_t>;

/// What a run must be given again to come out the same.
struct Event {
  std::uint64_t step = 0;  ///< at which it begins
  Poke poke;               ///< without a body: all pokes end
  std::uint32_t run = 0;   ///< World::run() that it belongs to
};

/// The same, of a frame of others that obstacles or pins follow.
struct FollowedFrame {
  std::uint64_t step = 0;    ///< from whose beginning on it holds
  std::uint32_t run = 0;     ///< World::run() that it belongs to
  std::uint32_t number = 0;  ///< within its run, from 1 on
  Glide glide;
};

/// Where in its runs a world is.
struct RunMark {
  std::uint32_t run = 0;       ///< World::run()
  std::uint64_t told = 0;      ///< step: events have told all that acted before it
  std::uint32_t followed = 0;  ///< how many FollowedFrames have been told of the run
};

/// A particle that is dragged (core/pull.h).
struct Pull {
  std::string body_name;
  BodyRef body;
  Vec3 target = Vec3::Zero();  ///< [m]
};

}  // namespace ragdoll
