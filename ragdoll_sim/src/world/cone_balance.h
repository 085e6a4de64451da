// What is left of bodies' momenta, spread over what touches them, within friction's cones.
//
// Least change of the impulses j_c by their weights w_c, so that each body's sum is right and each
// stays in its cone K_c: the projection onto the intersection of a subspace and a product of
// cones. Its dual is smooth and convex, one vector mu for each body:
//   j_c = P_Kc(j0_c + w_c (mu_first - mu_second)),   sum over a body's contacts of +-j_c = wanted,
// solved by Newton's method with the cones' generalised Jacobians [Facchinei2003]. What no impulse
// in the cones can give is spread without them.
#pragma once

#include <vector>

#include "ragdoll_sim/core/types.h"

namespace ragdoll {

/// An impulse on body `first`, and its opposite on `second`.
struct SharedImpulse {
  int first = -1, second = -1;  ///< -1: what takes any impulse
  double weight = 1;            ///< how easily it changes
  double friction = 0;          ///< what is told outside its cone has a wider one, or none
  Vec3 normal = Vec3::Zero();   ///< towards the first
  Vec3 impulse = Vec3::Zero();  ///< [N s] as told, and then as spread
};

/// rest: [N s] for each body, what its sum is to change by. Whether the cones can give it.
bool spreadWithinCones(const std::vector<Vec3>& rest, std::vector<SharedImpulse>& impulses);

}  // namespace ragdoll
