// One body during one step of a direct method: constants, views of the state, and what the stages
// hand to each other. Plain data; the stages are free functions, a file each.
#pragma once

#include <cstdint>
#include <vector>

#include "core/contact/pair_detect.h"
#include "core/direct/constraint_set.h"
#include "core/direct/impulse_cache.h"
#include "core/direct/runge_kutta.h"
#include "core/direct/saved_motion.h"
#include "core/direct/step_context.h"
#include "core/limits/limit_angles.h"
#include "core/linear/body_response.h"
#include "core/linear/implicit_sticks.h"
#include "core/mechanics/energy_gain.h"
#include "core/mechanics/joint_damping.h"

namespace ragdoll {

/// Of one body, kept from step to step: what is known of a step's end serves at the next start.
struct BodyMemory {
  BodyResponse response;
  LimitAngles angles;
  Schur schur;
};

/// Gives what is in it its size.
void makeRoom(const Skeleton& skeleton, const DirectSystem& system, BodyMemory& memory);

/// A motion over a part of the step.
struct Motion {
  Points dx;               ///< [m] 3 x n
  Eigen::VectorXd lambda;  ///< [kg] impulses of the sticks times h, padded
};

/// What a substep that is done again starts from.
struct SavedBody : SavedMotion {
  ImpulseCache cache;
  int located = 0;
};

/// A place of the workspace: its buffers stay from step to step.
struct Body {
  /// Binds a place of the workspace to a ragdoll.
  void bind(const StepContext& context, int ragdoll);
  /// Gives what is in it its size.
  void makeRoom(const DirectSystem& of);

  const StepContext* context = nullptr;
  const Ragdoll* ragdoll = nullptr;
  const Skeleton* skeleton = nullptr;
  const System* pinned = nullptr;  ///< its pins
  const DirectSystem* system = nullptr;
  const StickRows* rows = nullptr;
  BodyMemory* memory = nullptr;
  int index = 0, first = 0, n = 0;

  StickLengths lengths;  ///< that sticks keep in this step
  double pin_speed = 0;  ///< [m/s] of pins that move
  bool driven = false;   ///< something moves that gives energy: obstacles, pins
  double time = 0;       ///< [s] of the step at which the present trial begins
  int located = 0;       ///< impacts found in time in this step
  OverlapPolicy overlaps = OverlapPolicy::kResolve;
  // Forces that follow the motion (driving.h).
  bool pushed = false;        ///< a poke acts off its body's own point
  bool damps_within = false;  ///< damping is part of the motion
  double given = 0;           ///< [J] by pokes since the body was saved
  /// [J] by damping, likewise. Its two halves act on velocities between which something may press,
  /// and the second may give back what the first took of a motion that ends early; in all it gives
  /// nothing.
  double damped = 0;
  Points force;  ///< [N] of pokes, 3 x n, as in `acceleration`

  auto x() const { return context->state.x.middleCols(first, n); }
  auto v() const { return context->state.v.middleCols(first, n); }
  double* xData() const { return context->state.x.data() + 3 * first; }
  double* vData() const { return context->state.v.data() + 3 * first; }
  /// [kg/s^2] stick impulses per h^2: of the last motion, s of them, then of the one before.
  double* multipliers() const;
  // Of the stages.
  Motion motion, free;  ///< free: before contacts and limits
  ConstraintSet constraints;
  TouchingSet touching;
  ImpulseCache cache;
  SavedBody saved;
  Points acceleration;  ///< [m/s^2] of gravity and pokes, without sticks
  /// Scratch of single functions: to another it goes by argument, or as what is returned.
  Points v1, moved, kept;
  EnergyScratch energy;
  PairDetector detector;  ///< of the body with itself
  RungeKuttaScratch stages;
  ImplicitSticks implicit;
  RowValues total;  ///< [kg m] what the position stage's rows have pressed with in the motion
  Eigen::VectorXd tension, row_sums;
  Eigen::VectorXd lengths2, inverse_lengths2;  ///< of sticks that recover their lengths

  /// Whether the sticks have their lengths; before that angles mean nothing.
  bool isWhole() const { return lengths.length2 == rows->length2.data(); }
};

/// [kg]
inline MassMatrix massOf(Body& body) { return {*body.rows, body.energy}; }

/// Values in State::multipliers of one body.
inline int multiplierCount(const StickRows& rows) { return 2 * rows.s + 1; }

/// The thread's scratch for positions (3 x N).
Points& posesOf(const StepContext& context);
/// These with this body's columns at the end of its motion; the others mean nothing. Valid until
/// the thread's next call.
const Points& poseAfter(const Body& body);
/// This body's coordinates a moment after that; as long valid.
const double* aheadOf(const Body& body);
/// Limit angles at a pose (3 x N), there, and at the present positions.
LimitAngles::Pose& anglesAt(const Body& body, const Points& pose);
LimitAngles::Pose& anglesAfter(const Body& body);
LimitAngles::Pose& anglesBefore(const Body& body);

}  // namespace ragdoll
