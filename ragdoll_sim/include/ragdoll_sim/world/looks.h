// How obstacles look in rviz: calm colours with the light put into them (body/mesh.h, shade), tints
// that set neighbours apart, a floor whose checker shows scale and motion and fades into the
// background.
#pragma once

#include "ragdoll_sim/body/coat.h"
#include "ragdoll_sim/core/model.h"

namespace ragdoll {

/// Of one of the model's obstacles, in its own frame, lit as it stands at the start. Its index picks
/// the tint; of an endless plane as much is drawn as the bodies start on.
CoatShape obstacleLook(const Model& model, int index);

}  // namespace ragdoll
