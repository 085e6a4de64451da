// What the outside does to the world during one step. Applied at the step's beginning, never
// within.
#pragma once

#include <vector>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

struct Inputs {
  std::vector<Poke> pokes;  ///< forces to apply; step() uses those active at its step
  std::vector<Pose>
      obstacles;           ///< pose at the END of the step, one per obstacle; empty: none moves
  std::vector<Vec3> pins;  ///< target at the END of the step, one per pin; empty: none moves
};

/// The scene's scripted pokes, nothing else moving: what a run starts with.
Inputs startInputs(const Model& model);

/// True while the step that begins at `time` and lasts `h` belongs to the poke: start and duration
/// are rounded to whole steps, at least one.
bool isActive(const Poke& poke, double time, double h);

/// An order of pokes that depends only on when and on what they act: forces that are added in it
/// give the same sum in whatever order they were asked for. h: length of a step [s].
bool actsBefore(const Poke& a, const Poke& b, double h);

/// Spreads force and moment of one poke over the particles of its body: the smallest forces (least
/// squares) with the right sum and moment about the body's own point. A single particle takes no
/// moment, a bone or points in line none about themselves. Adds to forces (3 x N) [N].
void addForce(const Poke& poke, const State& state, Points& forces);
/// The same at positions x; x and forces begin at the particle `first`.
void addForce(const Poke& poke, const Eigen::Ref<const Points>& x, int first, Points& forces);
/// What of a poke's moment has no effect on its body at x (3 x N), in words; empty: nothing.
std::string lostMomentText(const Poke& poke, const Points& x);

}  // namespace ragdoll
