// Memory of the direct methods, sized by the first step. What it keeps from step to step (BodyMemory)
// saves work only: a step from the same state has the same bits with a fresh workspace.
#pragma once

#include <vector>

#include "core/contact/detect.h"
#include "core/direct/body.h"
#include "core/direct/island.h"
#include "core/direct/island_builder.h"

namespace ragdoll {

struct ContactLog;

struct DirectWorkspace {
  std::vector<SweptObstacle> obstacles;
  std::vector<BodyMemory> bodies;     ///< per ragdoll
  std::vector<int> first_multiplier;  ///< per ragdoll: its first in the state
  Points predicted;                   ///< [m] 3 x N: where motions lead (poseAfter)
  IslandScratch island, lone;         ///< lone: of bodies that an island gave up
  IslandBuilder builder;
  std::vector<CachedImpulse> impulses;    ///< of this step
  ContactLog* log = nullptr;              ///< of this step; null: nobody asks
  std::vector<int> lone_body, no_bodies;  ///< an island of one
};

}  // namespace ragdoll
