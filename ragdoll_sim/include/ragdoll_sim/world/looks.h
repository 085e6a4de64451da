// How obstacles look in rviz: calm colours with the light put into them (body/mesh.h, shade), tints
// that set neighbours apart, a floor whose checker shows scale and motion and fades into the
// background.
#pragma once

#include "ragdoll_sim/body/coat.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// In the obstacle's own frame, lit as it stands at the start. `index` picks the tint.
CoatShape obstacleLook(const Obstacle& obstacle, int index);

}  // namespace ragdoll
