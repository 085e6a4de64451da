// Obstacles that move, over a part of a step: evenly from where they are at its start to where they
// are at its end.
#pragma once

#include <vector>

#include "core/contact/detect.h"
#include "core/direct/body.h"

namespace ragdoll {

/// Share 0 ... 1 of the way from a to b, exact at both.
Pose between(const Pose& a, const Pose& b, double share);

/// The obstacles over h [s] from the beginning of the body's present trial on. Valid until the
/// thread's next call.
const std::vector<SweptObstacle>& obstaclesOver(const Body& body, double h);

/// Of a contact found with these: its motion in the part becomes that of a whole step.
void scaleMotion(const StepContext& step, double h, Contact& contact);

}  // namespace ragdoll
