// What the directions of joint limits are carried by: bones, rigid groups, and the frames of bones
// that their parents carry along (limit.h).
#pragma once

#include <array>
#include <utility>

#include "ragdoll_sim/core/limit.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/plane_limits.h"

namespace ragdoll {

/// Of a skeleton whose segments and joints are there. Directions are unit, in the rest pose's axes.
class JointFrames {
 public:
  explicit JointFrames(const Skeleton& skeleton) : s_(skeleton) {}

  /// A bone's ends, `from` being the one that `other` has too (the first if none is shared).
  std::pair<int, int> boneFrom(int segment, int other) const;
  /// Towards the joint that `child` hangs on.
  std::pair<int, int> parentBone(int parent, int child) const;
  Vec3 restDirection(const std::pair<int, int>& bone) const;
  static Direction boneAlong(const std::pair<int, int>& bone);
  /// A direction fixed in a segment. False: nothing shows it.
  bool fixedIn(int segment, const Vec3& rest, Direction& d, int depth = 0) const;
  /// Away from the joint: a bone's direction, or from the shared particles to the rest of a group.
  Vec3 childRest(int joint) const;
  /// A hinge on a bone, which bends to one side of it.
  struct Bend {
    Direction parent, child;  ///< the bones, away from the joint; the parent's straight on
    Direction forward;        ///< square to the parent: where the child bends to
    bool sided = false;       ///< something shows where `forward` is
    double side = 1;          ///< -1: it bends against its axis for most of its range
    double sine = 1;  ///< between axis and parent bone: what a turn about the axis bends less by
  };
  Bend bend(int joint) const;
  /// Where a hinge's angle is zero: straight on, or the rest pose on a rigid parent.
  Vec3 hingeZero(int joint) const;
  /// The regions of a `planes` joint; not yet its axes.
  PlaneLimit planes(int joint) const;
  /// A particle that both have, -1 if there is none.
  static int shared(const Segment& a, const Segment& b);

 private:
  int jointAbove(int segment) const;
  /// The segment whose frame a bone's frame is carried from, -1 if there is none.
  int parentOf(int segment) const;
  /// The three particles of a group that span the largest triangle; false if all are in line.
  bool triangle(const Segment& group, std::array<int, 3>& best) const;
  Vec3 coefficients(const std::array<int, 3>& base, const Vec3& v) const;
  /// The middle of what a joint allows its child.
  Vec3 centre(int segment) const;
  /// The mean of the directions that a `planes` joint allows; `rest` if they cancel.
  Vec3 meanAllowed(int joint, const Vec3& rest) const;

  const Skeleton& s_;
};

/// Angle between the bones [rad] for a turn about the hinge's axis, and back. They differ where the
/// axis is not square to the parent bone: sin(bend / 2) = sine sin(turn / 2).
double bendOfTurn(double turn, double sine);
double turnOfBend(double bend, double sine);

/// v turned by an angle [rad] about an axis.
Vec3 turned(double angle, const Vec3& axis, const Vec3& v);

}  // namespace ragdoll
