// Poses of all frames of all ragdolls, followed from state to state.
//
// Particles fix a bone's direction but not its twist, so the tracker carries the twist along
// (part_motion.h): call reset() at the start and after every jump, update() after every step (or
// every few; at most about a radian of motion in between). The same sequence of states gives the
// same bits. Copyable: a copy goes on alike. Quaternions keep their sign from update to update (no
// flips).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ragdoll_sim/body/frame_tree.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// Everything that coat, angles and publishers read: one moment of the whole world.
struct Posture {
  double time = 0;           ///< [s] of simulation
  Points x;                  ///< [m] 3 x N particles, world
  std::vector<Quat> parts;   ///< part -> world, all ragdolls in turn (FrameTracker::firstPart)
  std::vector<Pose> frames;  ///< frame -> world, all ragdolls in turn (FrameTracker::firstFrame)
};

class FrameTracker {
 public:
  /// prefix: of all frames' names, as it is.
  explicit FrameTracker(const Model& model, const std::string& prefix = "");

  /// Before reset(): follows these of all the parts alone, and what they turn by, with the same bits;
  /// frames are not placed any more. For who looks at few parts at every step.
  void followOnly(const std::vector<int>& parts);

  void reset(
      const State& state);  ///< twist from scratch; both ends of the interpolation are `state`
  void update(const State& state);  ///< follows the motion from the last state to this one

  const Posture& now() const { return now_; }
  const Posture& previous() const { return previous_; }
  /// Between the last two updates: alpha 0 the previous, 1 now; lerp of positions, slerp of turns.
  void interpolate(double alpha, Posture& out) const;

  int size() const { return static_cast<int>(names_.size()); }        ///< frames of all ragdolls
  const std::string& name(int frame) const { return names_[frame]; }  ///< "ragdoll/left_knee"
  int parent(int frame) const { return parents_[frame]; }  ///< index, -1: the world frame
  /// Pose in the parent frame (what TF wants).
  Pose local(const Posture& posture, int frame) const;

  int ragdolls() const { return static_cast<int>(bodies_.size()); }
  const FrameTree& tree(int ragdoll) const { return *bodies_[ragdoll].tree; }
  int firstFrame(int ragdoll) const { return bodies_[ragdoll].first_frame; }
  int firstPart(int ragdoll) const { return bodies_[ragdoll].first_part; }
  int firstParticle(int ragdoll) const { return bodies_[ragdoll].first_particle; }

 private:
  struct Body {
    std::shared_ptr<const FrameTree> tree;
    std::shared_ptr<const Points> rest;
    int first_particle = 0, first_part = 0, first_frame = 0;
    std::vector<int> followed;  ///< parts of the tree, ascending
  };
  void place(Posture& posture) const;  ///< frames from x and parts

  std::vector<Body> bodies_;
  std::vector<std::string> names_;
  std::vector<int> parents_;
  bool frames_ = true;  ///< are placed
  Posture now_, previous_;
};

}  // namespace ragdoll
