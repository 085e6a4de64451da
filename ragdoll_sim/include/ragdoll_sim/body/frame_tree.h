// Which frames and which rigid parts a skeleton has: constants, one per skeleton, shared by its
// ragdolls.
//
// A part is what turns as one: a group of particles (torso, pelvis) or a bone between two. A frame
// has its origin at a particle (the root frame: at the mean of some) and turns with one part. In
// the rest pose (standing, facing +x, z up) every frame is aligned with the world's axes.
//
// Human (all sixteen names of the thesis's body are there): world -> pelvis (midpoint of the hips)
// -> left_hip, right_hip, left_leg, right_leg, neck; leg -> knee -> foot; neck -> head,
// left_shoulder, right_shoulder; shoulder -> elbow -> hand. A frame turns with the part that begins
// at it: shoulder with the upper arm, elbow with the forearm, leg with the thigh, knee with the
// shank, neck with the torso, hips with the pelvis; head, hand and foot turn with the bone that
// ends there. Any other skeleton: breadth first along the sticks from the first particle of the
// largest group (without groups: the first particle); the largest group gets a root frame of its
// own at its middle.
#pragma once

#include <string>
#include <vector>

#include "ragdoll_sim/core/model.h"

namespace ragdoll {

struct Part {
  std::string name;            ///< the segment's, or "<from>_<to>" for a stick without one
  std::vector<int> particles;  ///< group: all; bone: from, to (of the skeleton)
  bool group = false;
  int parent = -1;  ///< part that a bone's twist refers to; always earlier in the list

  // Bones only. Unit vectors of the rest pose.
  Vec3 rest_direction = Vec3::Zero();    ///< from -> to
  Vec3 centre_direction = Vec3::Zero();  ///< the middle of what its joint can do; not for hinges
  bool hinged = false;                   ///< joined to its parent by a hinge:
  Vec3 hinge_axis = Vec3::Zero();        ///< fixed in the parent
  Vec3 straight = Vec3::Zero();          ///< direction at angle 0: the parent's continuation
  int bends = -1;                        ///< bone hinged to this one, whose bend shows its twist
  Vec3 bend_axis = Vec3::Zero();         ///< that hinge's axis
};

struct FrameSpec {
  std::string name;
  int parent = -1;             ///< frame; -1: the world. Parents come first.
  std::vector<int> particles;  ///< origin: their mean
  int part = -1;               ///< turns with it; -1 (a lone particle): never turns
};

struct FrameTree {
  std::vector<Part> parts;
  std::vector<FrameSpec> frames;
  bool human = false;

  int frame(const std::string& name) const;  ///< index, -1 if there is none
  int part(const std::string& name) const;   ///< index, -1 if there is none
  /// The part that consists of the segment's particles; -1 if there is none.
  int partOf(const Segment& segment) const;
};

FrameTree buildFrameTree(const Skeleton& skeleton);

}  // namespace ragdoll
