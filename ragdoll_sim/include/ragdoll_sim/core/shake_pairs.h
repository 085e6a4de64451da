// Bodies that touch bodies, direct methods.
//
// Each body takes its whole step by itself (sticks, limits, obstacles, guard). Contacts between
// bodies act as kicks of velocity at the step's start, J / h, equal and opposite, so that linear
// momentum is conserved to rounding; bodies that were kicked take their step again. Kicks are found
// by projected Gauss-Seidel [Moreau1988] on the displacements' linear model, which holds each
// body's sticks: u = P W J_c^T lambda, P of stick_solver.h, and start at those of the last step. A
// velocity stage of the same kind ends the step, in turn with each body's own contacts.
//
// Approximate: the linear model leaves out a body's own contacts and limits (a body on the floor
// answers less than it says), so that rounds converge linearly, the slower the heavier the upper
// of two bodies is; a residual is carried to the next step by the warm start. Contact planes are
// those of the motion without kicks.
#pragma once

#include <vector>

#include "ragdoll_sim/core/contact.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/limits.h"
#include "ragdoll_sim/core/step.h"

namespace ragdoll {

/// A contact between two bodies, with both bodies' answers to impulses on it.
struct BodyContact {
  Contact contact;
  double offset = 0;             ///< [m] at which overlap found at the start is let be
  std::size_t response[2] = {};  ///< in the pool: 9 n numbers, 3 x n for each world axis
  Eigen::Matrix3d A;             ///< [1/kg] its own answer
  double wn = 0, wt = 0;         ///< [1/kg] along and, a bound, across the normal
  Vec3 impulse = Vec3::Zero();   ///< [kg m]
};

struct ShakePairs {
  Points x0, v0, kick, u;
  std::vector<double> multipliers0, pool;
  std::vector<Contact> found;
  std::vector<BodyContact> contacts;
  std::vector<std::uint8_t> changed;  ///< per ragdoll
  struct Own {
    std::vector<Press> presses;
    std::vector<Contact> touching;
    std::vector<LimitRow> limits;
    StepReport report;
  };
  std::vector<Own> own;      ///< per ragdoll
  std::vector<Press> known;  ///< of the last step between bodies, sorted
};

/// As a step of every awake body in turn, and keeps them apart.
void stepTogether(const Model& model, const Inputs& inputs, double h, Workspace::Impl& ws,
                  State& state, StepReport& report);

}  // namespace ragdoll
