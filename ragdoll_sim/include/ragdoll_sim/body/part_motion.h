// How the orientation of one rigid part follows its particles. Pure functions; frames.cpp holds
// state.
//
// Group: the rotation that fits its points best since the rest pose (least squares [Horn1987],
// which always gives a proper rotation, planar groups included).
//
// Bone: two particles fix its direction d, not its twist about d. Ours, in the parent part's frame:
//   1. carry: the smallest rotation from the old direction to the new (parallel transport in time,
//   as
//      in a Bishop frame [Bishop1975]) moves the old orientation along; nothing can flip.
//   2. pull: where something determines the twist, turn about d towards it:
//      - the bend of the hinge beyond (elbow, knee) shows it, the more clearly the more it is bent;
//      - else the turn without twist from the rest pose, referenceOrientation below.
//      The pull per update is at most kPullGain times the motion seen by the parent and the
//      confidence in the target: a body that is still never turns, and no frame turns by more than
//      its particles' motion explains: |step| <= (1 + kPullGain) * (swing of the bone + swing of
//      the bone beyond).
// A rigid motion of all particles carries every frame along exactly, as all is relative to the
// parent.
#pragma once

#include "ragdoll_sim/body/frame_tree.h"

namespace ragdoll {

/// [rad/rad] A twist is tracked exactly while the bend beyond is more than asin(1 / kPullGain).
constexpr double kPullGain = 1.5;

/// Smallest rotation from one unit vector to another; opposite ones: about `fallback` made square.
Quat smallestRotation(const Vec3& from, const Vec3& to, const Vec3& fallback);

/// [rad] in [0, pi]: angle of a rotation; between two unit vectors (exact for small angles).
double angleOf(const Quat& q);
double angleBetween(const Vec3& a, const Vec3& b);

/// Group: rest -> world. `last` where the points do not determine it (coincident or on a line).
Quat groupOrientation(const Part& part, const Points& rest, const Eigen::Ref<const Points>& x,
                      const Quat& last);

/// Unit direction from -> to of a bone; `last` if it has no length or is not finite.
Vec3 boneDirection(const Part& part, const Eigen::Ref<const Points>& x, const Vec3& last);

/// The point that a part turns about: a bone's `from`, a group's mean. A point p of the rest pose
/// goes to anchor(x) + q * (p - anchor(rest)).
Vec3 partAnchor(const Part& part, const Eigen::Ref<const Points>& x);

/// Turn without twist that takes the rest direction to d, in the parent part's frame; stateless.
/// What a joint limit should measure from. Hinge: the turn about its axis, then the smallest
/// rotation to d; smooth but where d lies on the axis. Any other: the smallest rotations by way of
/// `centre_direction`, so that the only singular direction, opposite to it, is one where the limb
/// cannot point.
Quat referenceOrientation(const Part& part, const Vec3& d);

/// What moved since the last update, for one bone; everything in the world frame.
struct BoneMotion {
  Quat parent_before, parent_now;  ///< orientation of the parent part (identity without one)
  Quat before;                     ///< orientation of the bone
  Vec3 direction;                  ///< unit, now
  bool bends = false;              ///< there is a bone beyond the hinge:
  Vec3 beyond_before, beyond_now;  ///< its unit directions
};

/// Orientation of the bone now. With `free` the pull is not bounded (a start, not a motion).
Quat followBone(const Part& part, const BoneMotion& motion, bool free);

}  // namespace ragdoll
