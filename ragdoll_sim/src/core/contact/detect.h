// Which particles (spheres) and sticks (capsules) of the bodies may touch an obstacle during a
// step.
//
// A swept search: from where the body is to where it would go, in the obstacle's moving frame, by
// conservative advancement [Mirtich1996]; the contact plane is tangent at the place of first touch,
// so nothing tunnels at any speed. A stick presses at (c1, c2) along it, as in [Jakobsen2001, sec.
// 5].
#pragma once

#include <vector>

#include "core/contact/body_grid.h"
#include "core/contact/contact.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// An obstacle with what one step needs of it.
struct SweptObstacle {
  const Obstacle* obstacle;
  int index;               ///< of the model
  Eigen::Matrix3d R0, R1;  ///< frame -> world at the step's start and end
  Vec3 p0, p1;
  Bounds bounds;  ///< world, over the step; planes: unbounded
  bool moves;
  Vec3 turn = Vec3::Zero();  ///< [rad] rotation vector of the step, world

  Vec3 toStart(const Vec3& x) const { return R0.transpose() * (x - p0); }
  Vec3 toEnd(const Vec3& x) const { return R1.transpose() * (x - p1); }
};

/// An obstacle of a step, from pose to pose; of no index.
SweptObstacle sweepObstacle(const Obstacle& obstacle, const Pose& start, const Pose& end);

/// All obstacles of a step. end: poses at its end (empty: they stand still).
void sweepObstacles(const Model& model, const State& state, const std::vector<Pose>& end,
                    std::vector<SweptObstacle>& swept);

/// Appends the contacts of one ragdoll whose gap may close between x0 and x1 (3 x N), and those
/// within `margin` [m].
void appendContacts(const Model& model, const std::vector<SweptObstacle>& obstacles,
                    const Points& x0, const Points& x1, int ragdoll, double margin,
                    std::vector<Contact>& contacts);

/// The same of one particle, or one stick of its skeleton, and one obstacle alone, however far they
/// are from each other.
void appendParticleContact(const Model& model, const SweptObstacle& obstacle, const Points& x0,
                           const Points& x1, int ragdoll, int particle, double margin,
                           std::vector<Contact>& contacts);
void appendStickContacts(const Model& model, const SweptObstacle& obstacle, const Points& x0,
                         const Points& x1, int ragdoll, int stick, double margin,
                         std::vector<Contact>& contacts);

/// Appends those of the sticks that are deeper than `depth` [m] in an obstacle at x1, whatever they
/// touched on the way: a stick may turn over an edge after it has touched. Those whose axis is
/// inside are left out: their way out is not known.
void appendStickOverlaps(const Model& model, const std::vector<SweptObstacle>& obstacles,
                         const Points& x0, const Points& x1, int ragdoll, double depth,
                         std::vector<Contact>& contacts);

/// [m] from the surface of a stick, a capsule with these ends and radii in the obstacle's frame, to
/// the obstacle where they are nearest; negative: overlap.
double stickGap(const Obstacle& obstacle, const Vec3& a, const Vec3& b, double ra, double rb);

/// Contacts of all awake ragdolls between state.x and `predicted`, as appendContacts. obstacles:
/// scratch.
void findContacts(const Model& model, const State& state, const Points& predicted,
                  const std::vector<Pose>& obstacle_end, double margin,
                  std::vector<SweptObstacle>& obstacles, std::vector<Contact>& contacts);

}  // namespace ragdoll
