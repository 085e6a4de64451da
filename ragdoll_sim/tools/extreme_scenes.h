// Scenes that the stability matrix is made of. Lengths [m], masses [kg], speeds [m/s].
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/scene.h"

namespace ragdoll::lab {

constexpr const char* kFloor = "obstacles: [{type: plane, friction: 0.6}]\n";

/// One human; `start` is what its entry in `ragdolls` says, `rest` the other keys of the scene.
Scene humanScene(const std::string& start, const std::string& rest);

/// Particles of these masses, `link` apart on a line, joined by sticks, the first one pinned at
/// the origin. tilt [rad]: 0 hangs straight down.
Scene chainScene(const std::vector<double>& masses, double link, double tilt);

/// Five links of 0.3 m between particles of 1 kg, the last one `ratio` times as heavy; as above.
Scene massRatioChain(double ratio, double tilt);

constexpr double kMassRatioTilt = 1.2;  ///< [rad] of those that swing

/// The human's model with lengths and masses multiplied; inertias follow.
void scaleModel(Scene& scene, double length, double mass);

/// The human with all particles in the plane x = 0.
void flattenModel(Scene& scene);

/// "1e-06", "0.5": short and exact enough to name a test.
std::string shortNumber(double value);

}  // namespace ragdoll::lab
