// All that changes from step to step, and nothing else: copy it and the copy goes on to the same
// bits.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// What a contact or a limit pressed with in the last step: where the next one's solver starts.
struct CachedImpulse {
  int ragdoll = 0;
  int a = 0, b = -1;                 ///< contact: its first two particles; limit: -1 - limit, joint
  int obstacle = -1;                 ///< of a contact
  std::array<int, 2> other{-1, -1};  ///< body on body: the second stick's particles
  Vec3 impulse = Vec3::Zero();       ///< [N] contact, world; limit: x [N m]; half the force
};

struct State {
  std::uint64_t step = 0;
  double time = 0;                   ///< [s]
  Points x;                          ///< [m] 3 x N
  Points v;                          ///< [m/s] 3 x N
  std::vector<Pose> obstacles;       ///< where they are now
  std::vector<std::uint8_t> asleep;  ///< per ragdoll
  std::vector<double> quiet;         ///< [s] per ragdoll: how long it has been still
  /// [kg/s^2] of stick impulses per h^2, direct methods: per ragdoll those of the last motion, then
  /// those of the one before; last, within a tolerance, the part [s] that would be tried next.
  std::vector<double> multipliers;
  /// Direct methods: in the order of the last step's contacts and limits.
  std::vector<CachedImpulse> impulses;
  Points allowed;  ///< 3 x planes joints: the child's last allowed direction in its parent's axes
};

}  // namespace ragdoll
