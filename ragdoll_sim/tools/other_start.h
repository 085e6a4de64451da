// The same scene, begun otherwise: what is said of a scene holds for more than the one run that its
// file describes.
#pragma once

#include "ragdoll_sim/core/scene.h"

namespace ragdoll::lab {

/// With other velocities of each body at its start: by up to 0.5 m/s along and 1 rad/s about each
/// axis, at random by `seed`.
Scene withOtherStart(Scene scene, unsigned seed);

}  // namespace ragdoll::lab
