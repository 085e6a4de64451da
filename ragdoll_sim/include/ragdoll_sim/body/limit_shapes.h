// Joint limits to look at (~show_limits): the regions as in the thesis's figures 4.2 to 4.8, a red
// line where a region begins, a blue one where it ends, a translucent fan between them; a cone for
// a cone. They turn with the parent part. World frame, drawn at the joint.
#pragma once

#include <vector>

#include "ragdoll_sim/body/coat.h"

namespace ragdoll {

/// Of one ragdoll's joints. hinge: "<joint>/region", "<joint>/begin", "<joint>/end"; planes: the
/// same with "<joint>/xy/region" and so on; cone: "<joint>/region" and "<joint>/rim". The number
/// and the names stay the same as long as the model does.
std::vector<CoatShape> limitShapes(const Model& model, const FrameTracker& tracker,
                                   const Posture& posture, int ragdoll);

}  // namespace ragdoll
